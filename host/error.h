#pragma once
// The two ways a command can fail, and their exit codes.

#include <stdexcept>
#include <string>

namespace scree {

/// Bad input: scene, command line, file or option. Exit code 2; nothing was started or overwritten.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run that started and could not go on: device fault, non-finite state, disk full. Exit code 1.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace scree
