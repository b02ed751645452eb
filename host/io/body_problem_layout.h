#pragma once
// scree's own layout of contact problems in HDF5, with bodies. docs/problem_files.md.

#include "host/io/h5.h"
#include "host/problems/body_problem.h"

namespace scree {

/// Number of the layout; files of another version are refused.
inline constexpr int problem_format_version = 1;
/// The same with bilateral rows, which readers of version 1 would pass over.
inline constexpr int bilateral_version = 2;

/// What files in this layout say they are, in the attribute `format` and in their seal.
inline constexpr const char* problem_format_name = "scree contact problem";

/// Whether a file says that it is in this layout.
bool is_body_problem(const h5::Group& root);

/// @throws h5::Error, InputError naming what is wrong; shapes are checked, values are not
BodyProblem read_body_problem(const h5::Group& root);

/// @throws h5::Error
void write_body_problem(h5::Group& root, const BodyProblem& problem);

}  // namespace scree
