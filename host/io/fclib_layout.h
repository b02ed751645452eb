#pragma once
// FCLIB's layout of contact problems in HDF5, both kinds. docs/problem_files.md.
// Source: the fclib project, https://frictionalcontactlibrary.github.io, and its files.

#include "host/io/h5.h"
#include "host/problems/stored_problem.h"

namespace scree {

/// How a matrix is written; all are read.
enum class FclibStorage {
  triplets,  ///< nz >= 0
  columns,   ///< nz = -1, compressed columns
  rows       ///< nz = -2, compressed rows
};

/// Whether a file holds a problem in this layout.
bool is_fclib(const h5::Group& root);

/// Reads the problem, its texts, guesses and solution. Of M alone, a single stored triangle is
/// taken for both.
/// @throws h5::Error, InputError naming what is wrong; indices are checked, values are not
StoredProblem read_fclib(const h5::Group& root);

/// Writes a problem without bodies. @throws h5::Error
void write_fclib(h5::Group& root, const StoredProblem& problem, FclibStorage storage);

}  // namespace scree
