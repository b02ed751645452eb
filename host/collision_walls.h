#pragma once
// Walls of mechanical systems, with their derivatives and bounds of curvature.

#include <string>
#include <vector>

#include "host/mechanical_system.h"

namespace scree {

/// The set normal.q >= offset of the coordinates.
struct HalfSpaceOfCoordinates {
  std::vector<double> normal;  ///< n numbers, of any length but zero
  double offset = 0;
};

/// The system stays in a half-space.
Wall half_space_wall(std::string name, const HalfSpaceOfCoordinates& side);

/// The system stays where 1/2 q.A q + b.q + c >= 0: in or outside of an ellipse or a parabola, or two disks apart.
/// @param matrix  A, n x n row by row, symmetric
Wall quadric_wall(std::string name, std::vector<double> matrix, std::vector<double> linear,
                  double constant);

/// The system stays outside of a convex obstacle.
/// @param sides  half-spaces whose normals point out of the obstacle: it is what is in none of them
Wall convex_obstacle(std::string name, const std::vector<HalfSpaceOfCoordinates>& sides);

/// Two balls whose centers are `dimension` coordinates each, from first_a and first_b on.
struct BallPair {
  int coordinate_count = 6;
  int first_a = 0, first_b = 3;
  int dimension = 3;
  double distance = 0;  ///< of the centers where the balls touch [m], > 0
};

/// The balls stay apart. The value is the distance of the centers squared less `distance` squared, over 2 distance: near
/// contact the gap [m].
Wall ball_pair_wall(std::string name, const BallPair& pair);

/// A point of a plane body with the coordinates (x, y, angle) that are first, first + 1 and first + 2 of n.
struct PlaneBodyPoint {
  int coordinate_count = 3;
  int first = 0;
  double x = 0, y = 0;  ///< place in the frame of the body, from its center of mass [m]
};

/// The point of the body stays where normal.(place) >= offset.
/// @param normal_x,normal_y  of any length but zero; of length 1, the value is the distance [m]
Wall plane_body_wall(std::string name, const PlaneBodyPoint& point, double normal_x,
                     double normal_y, double offset);

}  // namespace scree
