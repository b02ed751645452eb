#pragma once
// Corners of elastic bodies, which their tetrahedra share, and elastic bodies as rigid ones.

#include "kernels/affine/step_programs.h"

namespace scree::affine {

/// A corner of an elastic body, where some body takes it.
struct SolidCorner {
  Index body = -1;  ///< a tetrahedron, or what the corner is attached to; -1: the world
  Vec3d rest;       ///< in coordinates of that body, or in the world [m]
};

/// Its coordinates are sums of those of its corners.
struct Tetrahedron {
  Index body = 0;            ///< as it is stored, behind all bodies of the scene
  Index corner[4] = {};      ///< in the list of all corners
  double weight[4][4] = {};  ///< of node j of AffineVec and corner v, at [j][v]
  Vec3d center;              ///< at rest, in the frame of its elastic body [m]
};

/// An elastic body.
struct Solid {
  Index body = 0;  ///< as it is stored
  Index id = 0;    ///< in the scene
  Index tetrahedra_begin = 0, tetrahedra_end = 0;
  Index corners_begin = 0, surface_end = 0;  ///< those of its surface come first
};

/// Where corners are. Bytes a corner: 32 read and 96 of its body, 24 written.
struct PlaceCorners {
  static constexpr const char* name = "affine_place_corners";
  Span<const SolidCorner> corners;
  Span<const AffineVec> q;  ///< by body
  Span<Vec3d> place;        ///< out

  SCREE_HD void operator()(Index i) const {
    const SolidCorner& c = corners[i];
    place[i] = c.body < 0 ? c.rest : point_of(q[c.body], c.rest);
  }
};

/// Tetrahedra from their corners: they share these whatever rounding did before. Bytes a tetrahedron: 176 and 96 read, 96 written.
struct JoinTetrahedra {
  static constexpr const char* name = "affine_join_tetrahedra";
  Span<const Tetrahedron> tetrahedra;
  Span<const Vec3d> place;
  Span<AffineVec> q;  ///< out, by body

  SCREE_HD void operator()(Index i) const {
    const Tetrahedron& t = tetrahedra[i];
    AffineVec joined;
    for (int j = 0; j < 4; ++j)
      for (int v = 0; v < 4; ++v) joined.node[j] += t.weight[j][v] * place[t.corner[v]];
    q[t.body] = joined;
  }
};

/// How far from rigid bodies of the scene are, but for elastic ones, of which nothing is known here. Bytes a body: 96 read, 8 written.
struct WriteStrains {
  static constexpr const char* name = "affine_write_strains";
  Span<const AffineVec> q;  ///< by body
  Span<double> strain;      ///< out, by body

  SCREE_HD void operator()(Index b) const { strain[b] = strain_norm(q[b]); }
};

/// Poses of elastic bodies as rigid ones: of the affine motion nearest to theirs, by mass. An item goes through a whole body.
struct WriteSolidPoses {
  static constexpr const char* name = "affine_write_solid_poses";
  static constexpr Index kSerialBelow = 2;
  Span<const BodyConstant> bodies;
  Span<const Solid> solids;
  Span<const Tetrahedron> tetrahedra;
  Span<const AffineVec> q, v;  ///< by body
  BodyView<double> store;
  Span<double> strain;  ///< out, by body: the largest of its tetrahedra

  SCREE_HD void operator()(Index i) const {
    const Solid& solid = solids[i];
    const AffineMass& mass = bodies[solid.body].mass;
    AffineVec all;  // the integral of density x (1, X)
    Vec3d velocity, momentum;
    double worst = 0;
    for (Index k = solid.tetrahedra_begin; k < solid.tetrahedra_end; ++k) {
      const Tetrahedron& t = tetrahedra[k];
      const AffineMass& own = bodies[t.body].mass;
      const AffineVec part = own.product(q[t.body]);
      for (int n = 0; n < 4; ++n)
        all.node[n] += (n == 0 ? Vec3d{} : part.node[n]) +
                       (own.mass * node_weight(t.center, n)) * q[t.body].node[0];
      velocity += (own.mass / mass.mass) * v[t.body].node[0];
      const double its = strain_norm(q[t.body]);
      worst = its > worst ? its : worst;
    }
    strain[solid.body] = worst;
    const AffineVec nearest = mass.solve(all);
    for (Index k = solid.tetrahedra_begin; k < solid.tetrahedra_end; ++k) {
      const Index b = tetrahedra[k].body;
      const AffineMass& own = bodies[b].mass;
      momentum += cross(q[b].node[0] - nearest.node[0], own.mass * (v[b].node[0] - velocity)) +
                  angular_momentum(own, q[b], v[b]);
    }
    write_pose(nearest, velocity, turn_rate(mass, nearest, momentum), solid.body, store);
  }
};

/// The surface of an elastic body in the frame of its pose, for pictures. Bytes a corner: 24 read, 24 written.
struct DrawCorners {
  static constexpr const char* name = "affine_draw_corners";
  Solid solid;
  Span<const Vec3d> place;  ///< of all corners
  BodyView<double> store;
  Span<Vec3d> vertices;  ///< out, of its mesh

  SCREE_HD void operator()(Index i) const {
    vertices[i] = rotate_back(store.orientation[solid.body],
                              place[solid.corners_begin + i] - store.position[solid.body]);
  }
};

}  // namespace scree::affine
