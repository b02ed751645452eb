#pragma once
// What is known of the shared FCLIB problems: the table that lies beside them.

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "tests/physics/shared_data.h"

namespace scree::fclib {

/// Figures of one problem in reference.csv.
struct Figures {
  std::string name;
  int dimension = 0, contact_count = 0;
  double mu_min = 0, mu_max = 0, norm_q = 0, asymmetry = 0, convex_minimum = 0;
};

/// Empty when the table is not there.
inline std::vector<Figures> figures() {
  std::vector<Figures> all;
  std::istringstream lines(physics::shared_text(physics::shared_file("fclib/reference.csv")));
  std::string line;
  std::getline(lines, line);  // header
  while (std::getline(lines, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    Figures f;
    if (words >> f.name >> f.dimension >> f.contact_count >> f.mu_min >> f.mu_max >> f.norm_q >>
        f.asymmetry >> f.convex_minimum)
      all.push_back(f);
  }
  return all;
}

}  // namespace scree::fclib
