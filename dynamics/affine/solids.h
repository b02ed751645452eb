#pragma once
// Elastic bodies in backend memory: their corners after a step, and what output shows of them.

#include <algorithm>
#include <vector>

#include "dynamics/affine/solid_setup.h"
#include "host/world.h"

namespace scree::affine {

template <class B>
class Solids {
 public:
  Solids(B& b, const SolidSetup& setup)
      : solids_(setup.solids),
        on_backend_(b),
        tetrahedra_(b),
        corners_(b),
        place_(b, std::ssize(setup.corners)),
        tetrahedron_count_(static_cast<Index>(setup.tetrahedra.size())) {
    upload(b, setup.solids, on_backend_);
    upload(b, setup.tetrahedra, tetrahedra_);
    upload(b, setup.corners, corners_);
  }

  bool empty() const { return solids_.empty(); }

  /// Lets tetrahedra share their corners to the last bit. @param q  by body
  void join(B& b, Span<AffineVec> q) {
    if (empty()) return;
    place(b, q);
    for_each(b, tetrahedron_count_,
             JoinTetrahedra{tetrahedra_.view(tetrahedron_count_),
                            std::as_const(place_).view(place_.capacity()), q});
  }

  /// Their poses as rigid bodies, and how strained they are. @param strain  by body
  void write_poses(B& b, Span<const BodyConstant> bodies, Span<const AffineVec> q,
                   Span<const AffineVec> v, const BodyView<double>& store, Span<double> strain) {
    const auto count = static_cast<Index>(solids_.size());
    for_each(b, count,
             WriteSolidPoses{bodies, on_backend_.view(count), tetrahedra_.view(tetrahedron_count_),
                             q, v, store, strain});
  }

  /// Adds where the vertices of meshes are, by id.
  void add_bent(B& b, Span<const AffineVec> q, BodyStates& states) {
    if (empty()) return;
    place(b, q);
    const std::vector<Vec3d> all = download(b, place_.view());
    for (const Solid& s : solids_)
      states.bent[s.id].assign(all.begin() + s.corners_begin, all.begin() + s.surface_end);
  }

  /// Writes where vertices of meshes are, in the frames of their bodies. @param vertices_of  (id): those of the mesh of a body
  template <class VerticesOf>
  void draw(B& b, Span<const AffineVec> q, const BodyView<double>& store, VerticesOf vertices_of) {
    if (empty()) return;
    place(b, q);
    for (const Solid& solid : solids_)
      for_each(b, solid.surface_end - solid.corners_begin,
               DrawCorners{solid, std::as_const(place_).view(place_.capacity()), store,
                           vertices_of(solid.id)});
  }

 private:
  void place(B& b, Span<const AffineVec> q) {
    const auto count = static_cast<Index>(place_.capacity());
    for_each(b, count, PlaceCorners{corners_.view(count), q, place_.view()});
  }

  std::vector<Solid> solids_;
  Buffer<B, Solid> on_backend_;
  Buffer<B, Tetrahedron> tetrahedra_;
  Buffer<B, SolidCorner> corners_;
  Buffer<B, Vec3d> place_;  ///< of corners [m]
  Index tetrahedron_count_;
};

}  // namespace scree::affine
