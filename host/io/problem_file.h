#pragma once
// Files of contact problems: with bodies in scree's own layout, as matrices in FCLIB's.
// docs/problem_files.md describes both.

#include <filesystem>

#include "host/error.h"
#include "host/io/fclib_layout.h"
#include "host/problems/stored_problem.h"

namespace scree {

/// Reads and checks a problem in whichever layout the file has. One without a seal (seal.h) is read
/// in a child process first, so that what crashes HDF5 is an error here.
/// @throws InputError naming the file, the dataset or value that is wrong and what was expected:
///         no such file, not HDF5, no problem in it, missing groups, sizes that disagree, indices
///         out of range, values that are not finite or have the wrong sign, no contacts, data in
///         other files, more data than the file can hold; NoProblemInFile
StoredProblem read_problem(const std::filesystem::path& path);

/// A readable HDF5 file that holds something else, as checkpoints are.
class NoProblemInFile : public InputError {
 public:
  using InputError::InputError;
};

/// Checks and writes a problem: with bodies in scree's layout, else in FCLIB's, matrices
/// stored as that library's collection has them (local: rows, global: triplets) or as told.
/// Replaces the file in one rename.
/// @throws InputError when the problem is not valid, RunError naming the file and the reason
void write_problem(const std::filesystem::path& path, const StoredProblem& problem);
void write_problem(const std::filesystem::path& path, const StoredProblem& problem,
                   FclibStorage storage);

}  // namespace scree
