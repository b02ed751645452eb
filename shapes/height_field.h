#pragma once
// Terrain from a grid of heights. It is read as a mesh, the closed surface of the solid below the heights, and is one
// from then on: contacts, pictures and output know meshes only.

#include "shapes/mesh.h"

namespace scree::shapes {

struct HeightField : Mesh {
  static constexpr ShapeKind kind{12};
  static constexpr const char* name = "height_field";
  static constexpr const char* description = "terrain from a grid of heights, read as a mesh";
  static constexpr ShapeKey keys[]{
      {"file", ShapeKey::Type::file,
       ".csv table of heights or gray .png picture, relative to the scene file; rows as in "
       "heights."},
      {"heights", ShapeKey::Type::heights,
       "rows of heights, each along x; the first row is at the largest y, as on a map."},
      {"extent", ShapeKey::Type::extent, "full edge lengths along x and y [m], positive.", true},
      {"height_scale", ShapeKey::Type::scale,
       "heights of a table are multiplied by this [m per unit of the table]."},
      {"height_offset", ShapeKey::Type::offset, "is added to the heights of a table [m]."},
      {"height_range", ShapeKey::Type::range, "heights of black and of white in a picture [m]."},
      {"thickness", ShapeKey::Type::length,
       "how far the solid goes on below its lowest point [m]; without it, a tenth of the longer "
       "edge."}};

  static void read(const ShapeSource& source, Shape& shape, Vec3d&) {
    shape.kind = Mesh::kind;
    shape.mesh = source.height_field();
  }
};

}  // namespace scree::shapes
