#pragma once
// The product of a block matrix with a vector as each backend does it best: the element program on
// a CPU, cuSPARSE on a GPU.

#include <memory>

#include "kernels/backend/backend.h"
#include "kernels/math/block_rows.h"

namespace scree {

class Cuda;

/// Computes y = W x. Create once per backend and reuse: on a GPU it holds a library handle.
template <class B>
class BlockProduct {
 public:
  explicit BlockProduct(B&) {}
  /// @param w     in backend memory, as are x and y [3 row_count], which are different arrays
  void operator()(B& b, const BlockRows& w, Span<const double> x, Span<double> y) const {
    for_each(b, w.row_count, BlockRowProduct{w, x, y});
  }
};

/// By cuSPARSE, bsrmv with blocks stored by rows, on the stream of the backend. Sums of a row have
/// an order of their own, the same on every run.
template <>
class BlockProduct<Cuda> {
 public:
  /// @throws DeviceError when the library cannot be set up
  explicit BlockProduct(Cuda& cuda);
  ~BlockProduct();
  BlockProduct(BlockProduct&&) noexcept;
  BlockProduct& operator=(BlockProduct&&) noexcept;
  /// @throws DeviceError when the launch fails
  void operator()(Cuda& cuda, const BlockRows& w, Span<const double> x, Span<double> y) const;

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace scree
