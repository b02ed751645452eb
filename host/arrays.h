#pragma once
// Arrays of a running World in the memory of its backend, handed out without a copy. What is here
// maps one to one to DLPack and to the array interfaces of NumPy and CuPy.

#include <array>
#include <cstdint>
#include <string>

namespace scree {

enum class BackendKind { cpu, cuda };

enum class DataType : std::uint8_t { float32, float64, int32, uint8 };

/// What World::array() can hand out. docs/user_guide.md has the table.
struct ArrayInfo {
  std::string name;
  std::string unit;     ///< "1" where there is none
  std::string meaning;  ///< one line
  bool writable = false;
};

/// A borrowed array, one row per body or contact.
struct ArrayView {
  void* data = nullptr;  ///< in the memory of the device; null only without rows
  DataType type = DataType::float32;
  int dimensions = 1;                      ///< 1: a number a row; 2: several
  std::array<std::int64_t, 2> shape{};     ///< rows, numbers a row (1 with one dimension)
  std::array<std::int64_t, 2> strides{};   ///< from row to row and from number to number [bytes]; a
                                           ///< constant that all bodies share has row stride 0
  bool writable = false;                   ///< else the program that holds it must only read
  BackendKind backend = BackendKind::cpu;  ///< cpu: host memory
  int device = 0;                          ///< number of the device
  void* stream = nullptr;  ///< the cudaStream_t on which the World works; null on the CPU
};

/// Which arrays a program has written to, for World::arrays_changed().
enum class Written : std::uint8_t {
  velocities,  ///< velocity, angular_velocity
  poses        ///< position, orientation, and maybe velocities too
};

}  // namespace scree
