#pragma once
// What a shape says of itself to the host. Its file holds what its card is made of; scene reader, scene check,
// schema, memory forecast and output read the card, so that a shape is known everywhere by its own file
// and a line in the list of shapes/CMakeLists.txt. Element programs of pictures take the functions of
// that file themselves (shapes/shape_types.h); those of contacts, the pair functions of
// kernels/narrow_phase/pairs/.

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shapes/chord.h"
#include "shapes/ray.h"
#include "shapes/shape.h"
#include "shapes/surface.h"

namespace scree {

/// What is wrong with one value: the field below the body's path, its value and what was expected.
struct Fault {
  std::string field;     ///< such as "radius"; empty: the body as a whole
  std::string value;     ///< as text
  std::string expected;  ///< such as "must be positive [m]"
};

/// Fault of a length of a shape: not positive, or out of the range that runs compute with.
std::optional<Fault> length_fault(const char* field, double value);
/// The same of three.
std::optional<Fault> lengths_fault(const char* field, const Vec3d& value);
/// Fault of a vector whose length is not one.
std::optional<Fault> unit_fault(const char* field, const Vec3d& value);

/// Of a radius by which a shape is rounded. @param longest  half edge of the box about the shape [m]
std::optional<Fault> rounding_fault(double radius, double longest);

/// Of the half extents of a shape that is round about z.
std::optional<Fault> round_fault(const Shape& shape);

/// "[1, 2, 3]", for messages.
std::string vector_text(const Vec3d& value);

/// A key of scene files that says something about a shape.
struct ShapeKey {
  enum class Type {
    length,
    vector,
    points,
    faces,
    file,
    scale,
    flag,
    parts,
    overlaps,
    heights,
    extent,
    offset,
    range
  };
  const char* key;
  Type type;
  const char* text;  ///< what it is, with its unit
  bool is_required = false;
};

/// The key of shapes that can be rounded.
inline constexpr ShapeKey kRoundingKey{
    "rounding", ShapeKey::Type::length,
    "radius of a ball that is swept along the shape, which rounds its edges and adds to its sizes "
    "on every side [m]."};

/// The entry of a scene file that a shape is read from. A value that does not fit is refused with
/// file, key, value and what was expected.
class ShapeSource {
 public:
  virtual ~ShapeSource() = default;
  virtual bool has(const char* key) const = 0;
  virtual double length(const char* key) const = 0;    ///< positive [m]
  virtual Vec3d edges(const char* key) const = 0;      ///< three positive lengths [m]
  virtual Vec3d direction(const char* key) const = 0;  ///< of length 1
  virtual Vec3d point(const char* key, const char* expected) const = 0;  ///< [m]
  /// Bits of the faces -x +x -y +y -z +z that a list names.
  virtual unsigned faces(const char* key) const = 0;
  /// Makes a shape the mesh that the keys `file`, `scale` and `closed` describe.
  virtual void read_mesh(Shape& shape) const = 0;
  /// Index of the mesh that the keys of a height field describe.
  virtual int height_field() const = 0;
  /// Makes a shape the convex hull of `points`, or of those of a `file` with a `scale`.
  virtual void read_hull(Shape& shape) const = 0;
  /// Makes a shape the compound of `parts`.
  virtual void read_compound(Shape& shape) const = 0;
  virtual void exclude(std::span<const char* const> keys, const char* why) const = 0;
  [[noreturn]] virtual void refuse(const char* key, const char* expected) const = 0;
};

struct MassProperties {
  double mass = 0;  ///< [kg]
  Vec3d inertia;    ///< principal moments, body frame [kg m^2]
};

/// A wall that a shape puts up as an infinite plane, body frame.
struct WallFace {
  const char* name = "";  ///< such as "-x"; empty: it has only one
  Vec3d point;            ///< on the plane [m]
  Vec3d normal;           ///< unit; bodies are on this side
};

struct ShapeCard {
  ShapeKind kind;
  const char* name;         ///< in scenes and files: that of its file
  const char* description;  ///< what it is, in one line
  std::span<const ShapeKey> keys;
  bool is_ball;      ///< bodies have no shape record, contacts are radial
  bool has_mesh;     ///< its surface is a mesh of the scene
  bool is_hull;      ///< that mesh is convex, and scaled to the half extents
  bool is_compound;  ///< that mesh holds its parts, and is scaled to the half extents
  /// Reads what the keys say. @param position  of the body [m]; a shape may set it
  void (*read)(const ShapeSource& source, Shape& shape, Vec3d& position);
  std::optional<Fault> (*fault)(const Shape& shape);
  /// Radius of the sphere about the center of the body that holds it [m]; 0: unbounded.
  double (*bounding_radius)(const Shape& shape, const TriangleMesh* mesh);
  /// @param scene_size  half edge of what is unbounded [m]
  Surface (*surface)(const Shape& shape, const TriangleMesh* mesh, double scene_size);
  /// Of a solid of that density [kg/m^3]; null: bodies of this shape cannot be free.
  MassProperties (*mass)(const Shape& shape, double density);
  /// Point farthest along a direction, body frame [m]; null: unbounded.
  Vec3d (*support)(const Shape& shape, const TriangleMesh* mesh, const Vec3d& direction);
  /// The planes that it is as a wall; null: it is a solid.
  std::vector<WallFace> (*faces)(const Shape& shape);
  /// By how much its vertices are rounded [m]; null: not at all.
  double (*rounding)(const Shape& shape);
  /// What of a line x + t d is in it, body frame [m]; null: it cannot be where parts overlap.
  Chord (*chord)(const Shape& shape, const TriangleMesh* mesh, const Vec3d& x, const Vec3d& d);
  /// The same shape with all its lengths multiplied by a factor; null: there is no such shape.
  Shape (*scaled)(const Shape& shape, double factor);
  bool is_named;  ///< scenes have a name for it
  /// Mass of the solid inside a surface that can be free only in models of dynamics whose bodies are
  /// surfaces (DynamicsCard::meshes_may_be_free); null: it has none.
  MassProperties (*mass_inside)(const Shape& shape, double density);

  bool may_be_free() const { return mass != nullptr; }
  /// @param meshes_may_be_free  in the model of dynamics
  bool may_be_free_where(bool meshes_may_be_free) const {
    return may_be_free() || (meshes_may_be_free && mass_inside != nullptr);
  }
  bool may_be_part() const { return may_be_free() && !is_compound; }
  /// Planes around a bounded inside.
  bool is_room() const { return faces != nullptr && support != nullptr; }
};

/// Scales a shape that is what its lengths are.
inline Shape with_scaled_lengths(const Shape& shape, double factor) {
  Shape scaled = shape;
  scaled.radius *= factor;
  scaled.half_extents *= factor;
  return scaled;
}

/// The card of a shape from what its file holds.
template <class S>
constexpr ShapeCard card_of() {
  ShapeCard card{S::kind,
                 S::name,
                 S::description,
                 S::keys,
                 false,
                 false,
                 false,
                 false,
                 &S::read,
                 &S::fault,
                 &S::bounding_radius,
                 &S::surface,
                 {},
                 {},
                 {},
                 {},
                 {},
                 {},
                 true,
                 {}};
  card.is_ball = S::outline == Outline::ball;
  if constexpr (requires { S::is_hull; }) card.is_hull = S::is_hull;
  if constexpr (requires { S::is_compound; }) card.is_compound = S::is_compound;
  card.has_mesh = S::outline == Outline::triangles || card.is_hull || card.is_compound;
  if constexpr (requires { &S::mass; }) card.mass = &S::mass;
  if constexpr (requires { &S::mass_inside; }) card.mass_inside = &S::mass_inside;
  if constexpr (requires { &S::farthest; }) card.support = &S::farthest;
  if constexpr (requires { &S::faces; }) card.faces = &S::faces;
  if constexpr (requires { &S::rounding; }) card.rounding = &S::rounding;
  if constexpr (requires { &S::chord; }) card.chord = &S::chord;
  if constexpr (requires { S::is_named; }) card.is_named = S::is_named;
  if constexpr (requires { &S::scaled; })
    card.scaled = &S::scaled;
  else if (!card.has_mesh || card.is_hull)
    card.scaled = &with_scaled_lengths;
  return card;
}

/// The shapes that this program has, in the order of the list.
const std::vector<ShapeCard>& shape_cards();

/// Whether this program has that shape.
bool is_shape(ShapeKind kind);
/// @throws std::logic_error for no shape of this program
const ShapeCard& shape_card(ShapeKind kind);

/// Whether a shape is a hull, rounded or not: its mesh is that of the scene, which is convex.
inline bool has_hull(const Shape& shape) {
  return shape_card(shape.kind).is_hull ||
         (is_shape(shape.rounded.core) && shape_card(shape.rounded.core).is_hull);
}

/// "sphere, box and capsule": names of the shapes that fit.
/// @param last  before the last of them
template <class Fits>
std::string shape_names(Fits fits, const char* last = " and ") {
  std::vector<std::string> names;
  for (const ShapeCard& card : shape_cards())
    if (card.is_named && std::invoke(fits, card)) names.emplace_back(card.name);
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 < names.size() ? ", " : last) + names[k];
  return text;
}

}  // namespace scree
