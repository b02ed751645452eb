#pragma once
// An assembled problem in the memory of a backend, and vectors beside it.

#include <vector>

#include "kernels/backend/block_product.h"
#include "solvers/assembled/assembled_monitor.h"

namespace scree {

/// W, q and mu on backend B. Impulses and velocities are [3 contact_count] doubles there.
template <class B>
class BackendProblem {
 public:
  /// Copies the problem: 76 bytes a block and 40 a contact. All arguments outlive this.
  BackendProblem(B& b, const BlockProduct<B>& product, const AssembledProblem& p)
      : backend_(&b),
        host_(&p),
        product_(&product),
        row_start_(b),
        column_(b),
        diagonal_at_(b),
        block_(b),
        q_(b),
        mu_(b) {
    upload(b, p.row_start, row_start_);
    upload(b, p.column, column_);
    upload(b, p.diagonal_at, diagonal_at_);
    upload(b, p.block, block_);
    upload(b, p.q, q_);
    upload(b, p.mu, mu_);
  }

  B& backend() const { return *backend_; }
  const AssembledProblem& host() const { return *host_; }
  Index contact_count() const { return host_->contact_count; }
  Index row_count() const { return 3 * host_->contact_count; }
  BlockRows rows() const {
    const Offset n = contact_count();
    return {contact_count(), row_start_.view(n + 1), column_.view(column_.capacity()),
            block_.view(block_.capacity()), diagonal_at_.view(n)};
  }
  Span<const double> q() const { return q_.view(row_count()); }
  Span<const double> mu() const { return mu_.view(contact_count()); }

  /// A vector of this problem's size, from the host or uninitialized.
  Buffer<B, double> vector() const { return Buffer<B, double>(*backend_, row_count()); }
  Buffer<B, double> vector(const std::vector<double>& values) const {
    Buffer<B, double> out(*backend_);
    upload(*backend_, values, out);
    return out;
  }

  /// y = W x, or W' x. @param x, y  of this backend, different ones
  void multiply(const Buffer<B, double>& x, Buffer<B, double>& y) const {
    (*product_)(*backend_, rows(), x.view(row_count()), y.view(row_count()));
    if (host_->held) subtract_change(x, y.view(row_count()));
  }

  /// Where rows are held: q of the contacts with the impulses that these rows have beside r, which
  /// makes W r + q the velocity; else nothing. @param q  out
  void hold_rows(const Buffer<B, double>& r, Buffer<B, double>& q) const {
    if (!host_->held) return;
    upload(*backend_, host_->q, q);
    subtract_change(r, q.view(row_count()));
  }

  /// Lets the monitor check impulses: brings them and W r to the host, 48 bytes a contact.
  /// @param moved  W r
  /// @return whether to stop
  bool check(AssembledMonitor& monitor, int iteration, const Buffer<B, double>& r,
             const Buffer<B, double>& moved) const {
    std::vector<double> u = download(*backend_, moved.view(row_count()));
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += host_->q[i];
    return monitor.check(iteration, download(*backend_, r.view(row_count())), u);
  }

 private:
  /// y -= V R^-1 V^T x. Factors of R are on the host.
  void subtract_change(const Buffer<B, double>& x, Span<double> y) const {
    if constexpr (!B::kIsDevice) {
      const Span<const double> at = x.view(row_count());
      const std::vector<double> change = host_->held->change({at.data, at.data + at.size});
      for (Offset i = 0; i < row_count(); ++i) y[i] -= change[static_cast<std::size_t>(i)];
    }
  }

  B* backend_;
  const AssembledProblem* host_;
  const BlockProduct<B>* product_;
  Buffer<B, Index> row_start_, column_, diagonal_at_;
  Buffer<B, Block3> block_;
  Buffer<B, double> q_, mu_;
};

/// Element program over contacts: Euclidean projection on the cones, in place.
struct ProjectOnCones {
  static constexpr const char* name = "project_on_cones";
  Span<const double> mu;
  Span<double> x;
  SCREE_HD void operator()(Index c) const { project_on_cone(mu[c], &x[3 * Offset{c}]); }
};

}  // namespace scree
