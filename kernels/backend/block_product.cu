// The block product of the CUDA backend, the only unit that knows cuSPARSE.
#include <cusparse.h>

#include "kernels/backend/block_product.h"
#include "kernels/backend/cuda.cuh"

namespace scree {
namespace {

void check_cusparse(cusparseStatus_t status, const char* what) {
  if (status != CUSPARSE_STATUS_SUCCESS)
    throw DeviceError(std::string("cuSPARSE: ") + cusparseGetErrorString(status) + " (" + what +
                      ")");
}

}  // namespace

struct BlockProduct<Cuda>::Library {
  cusparseHandle_t handle = nullptr;
  cusparseMatDescr_t description = nullptr;

  Library() = default;
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    if (description != nullptr) cusparseDestroyMatDescr(description);
    if (handle != nullptr) cusparseDestroy(handle);
  }
};

BlockProduct<Cuda>::BlockProduct(Cuda& cuda) : library_(std::make_unique<Library>()) {
  check_cusparse(cusparseCreate(&library_->handle), "create");
  check_cusparse(cusparseSetStream(library_->handle, cuda.stream()), "set stream");
  // Index base zero and a general matrix are what a description starts with.
  check_cusparse(cusparseCreateMatDescr(&library_->description), "describe matrix");
}
BlockProduct<Cuda>::~BlockProduct() = default;
BlockProduct<Cuda>::BlockProduct(BlockProduct&&) noexcept = default;
BlockProduct<Cuda>& BlockProduct<Cuda>::operator=(BlockProduct&&) noexcept = default;

void BlockProduct<Cuda>::operator()(Cuda& cuda, const BlockRows& w, Span<const double> x,
                                    Span<double> y) const {
  if (w.row_count == 0) return;
  const double one = 1, zero = 0;
  check_cusparse(
      cusparseDbsrmv(library_->handle, CUSPARSE_DIRECTION_ROW, CUSPARSE_OPERATION_NON_TRANSPOSE,
                     w.row_count, w.row_count, static_cast<int>(w.block.size), &one,
                     library_->description, w.block.data->data(), w.start.data, w.column.data, 3,
                     x.data, &zero, y.data),
      "block product");
  cuda.check_launch("block_product");
}

}  // namespace scree
