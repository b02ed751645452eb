#include "host/io/frame_reader.h"

#include <fmt/format.h>

#include <tuple>

#include "host/error.h"
#include "host/io/h5.h"

namespace scree {

FrameReader::FrameReader(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}", path.string(), what));
  };
  try {
    const h5::File file = h5::File::open_foreign(path);
    const h5::Group vtk = file.root().open_group("VTKHDF");
    times_ = vtk.read_converted<double>("Steps/Values");
    const auto bodies_of = vtk.read_converted<std::int64_t>("NumberOfPoints");
    if (times_.empty()) refuse("holds no frames");
    if (bodies_of.size() != 1)
      refuse("bodies were added in the run, expected all of them from the start");
    bodies_ = static_cast<std::size_t>(bodies_of[0]);
    const std::size_t rows = times_.size() * bodies_;
    for (const auto& [name, columns, values] :
         {std::tuple{"Points", 3, &position_},
          {"PointData/orientation", 4, &orientation_},
          {"PointData/velocity", 3, &velocity_},
          {"PointData/angular_velocity", 3, &angular_velocity_}}) {
      *values = vtk.read_converted<double>(name);
      if (values->size() != rows * static_cast<std::size_t>(columns))
        refuse(fmt::format("{} has {} numbers, expected {} for {} frames of {} bodies", name,
                           values->size(), rows * static_cast<std::size_t>(columns), times_.size(),
                           bodies_));
    }
  } catch (const h5::Error& error) {
    throw InputError(error.what());
  }
}

BodyStates FrameReader::states(std::size_t frame) const {
  BodyStates states;
  const auto vectors = [&](const std::vector<double>& from, std::vector<Vec3d>& to) {
    to.reserve(bodies_);
    for (std::size_t i = frame * bodies_; i < (frame + 1) * bodies_; ++i)
      to.push_back({from[3 * i], from[3 * i + 1], from[3 * i + 2]});
  };
  vectors(position_, states.position);
  vectors(velocity_, states.velocity);
  vectors(angular_velocity_, states.angular_velocity);
  states.orientation.reserve(bodies_);
  for (std::size_t i = frame * bodies_; i < (frame + 1) * bodies_; ++i)
    states.orientation.push_back(
        normalized(Quatd{orientation_[4 * i], orientation_[4 * i + 1], orientation_[4 * i + 2],
                         orientation_[4 * i + 3]}));
  return states;
}

}  // namespace scree
