#include "host/io/contact_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "host/error.h"
#include "host/io/vtkhdf.h"

namespace scree {
namespace {

using vtkhdf::append_number;
using vtkhdf::counting;
using vtkhdf::topologies;

constexpr std::uint64_t kPointChunk = 1024;
constexpr std::array kVectors{"normal", "force"};
constexpr std::array kNumbers{"force_magnitude", "gap"};
constexpr std::array kBodies{"body_a", "body_b"};

std::vector<std::string> data_names() {
  std::vector<std::string> names;
  names.reserve(kVectors.size() + kNumbers.size() + kBodies.size());
  for (const char* name : kVectors) {
    names.emplace_back(name);
  }
  for (const char* name : kNumbers) {
    names.emplace_back(name);
  }
  for (const char* name : kBodies) {
    names.emplace_back(name);
  }
  return names;
}

ContactExtent extended(const ContactExtent& before, std::uint64_t contacts) {
  return {before.frames + 1, before.points + contacts, std::max(before.most, contacts)};
}

/// Numbers of all contacts, one after the other. @param f  appends those of one contact
template <class T, class F>
std::vector<T> column(const std::vector<ContactRecord>& contacts, F f) {
  std::vector<T> out;
  out.reserve(3 * contacts.size());
  for (const ContactRecord& contact : contacts) f(contact, out);
  return out;
}

template <class T>
void add_vector(const Vec3d& v, std::vector<T>& out) {
  for (const double x : {v.x, v.y, v.z}) out.push_back(static_cast<T>(x));
}

template <class T>
void append(h5::Group& group, const char* name, const std::vector<T>& rows) {
  group.append(name, std::span<const T>(rows));
}

}  // namespace

ContactFrameWriter::ContactFrameWriter(std::filesystem::path path, double time_step,
                                       Precision precision, std::optional<double> resume_time)
    : file_(std::move(path)), time_step_(time_step), precision_(precision) {
  if (resume_time) resume(*resume_time);
  if (extent_.frames == 0) start();
}

Filled ContactFrameWriter::filled() const {
  const auto frames = static_cast<std::uint64_t>(extent_.frames);
  std::vector<Growing> all{{"NumberOfPoints", frames}, {"Points", extent_.points}};
  for (const char* name : topologies) {
    const bool used = name == topologies[0];
    all.push_back({fmt::format("{}/NumberOfCells", name), frames});
    all.push_back({fmt::format("{}/NumberOfConnectivityIds", name), frames});
    all.push_back({fmt::format("{}/Offsets", name), (used ? extent_.points : 0) + frames});
    if (used) all.push_back({fmt::format("{}/Connectivity", name), extent_.most});
  }
  for (const char* name : {"Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets",
                           "ConnectivityIdOffsets"})
    all.push_back({fmt::format("Steps/{}", name), frames});
  for (const std::string& name : data_names()) {
    all.push_back({"PointData/" + name, extent_.points});
    all.push_back({"Steps/PointDataOffsets/" + name, frames});
  }
  for (Growing& dataset : all) dataset.name = "VTKHDF/" + dataset.name;
  return {extent_.frames, std::move(all)};
}

void ContactFrameWriter::start() {
  extent_ = {};
  file_.start([&](h5::Group root) {
    h5::Group vtk = vtkhdf::create_poly_data(root);
    vtk.create_growing<std::int64_t>("NumberOfPoints", 0, vtkhdf::frame_chunk);
    vtk.create_growing<double>("Points", 3, kPointChunk);
    // Cell i of every frame is the vertex i: one connectivity serves all frames.
    for (const char* name : topologies) {
      h5::Group topology = vtk.create_group(name);
      for (const char* number : {"NumberOfCells", "NumberOfConnectivityIds"})
        topology.create_growing<std::int64_t>(number, 0, vtkhdf::frame_chunk);
      topology.create_growing<std::int64_t>("Offsets", 0, kPointChunk);
      topology.create_growing<std::int64_t>("Connectivity", 0, kPointChunk);
    }
    h5::Group data = vtk.create_group("PointData");
    const auto create = [&](const char* name, std::uint64_t columns) {
      if (precision_ == Precision::double_precision)
        data.create_growing<double>(name, columns, kPointChunk);
      else
        data.create_growing<float>(name, columns, kPointChunk);
    };
    for (const char* name : kVectors) create(name, 3);
    for (const char* name : kNumbers) create(name, 0);
    for (const char* name : kBodies) data.create_growing<std::int32_t>(name, 0, kPointChunk);
    vtkhdf::create_steps(vtk, "PointData", data_names());
  });
}

void ContactFrameWriter::resume(double time) {
  const std::filesystem::path& path = file_.path();
  if (!std::filesystem::exists(path)) return;
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("cannot continue {}: {}", path.string(), what));
  };
  std::int64_t frames_found = 0;
  try {
    const h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    const h5::Group vtk = root.open_group("VTKHDF");
    frames_found = vtk.open_group("Steps").attribute<std::int64_t>("NSteps");
    const auto times = vtk.read<double>("Steps/Values");
    const auto contacts = vtk.read<std::int64_t>("NumberOfPoints");
    if (std::ssize(times) != frames_found || times.size() != contacts.size())
      refuse(fmt::format("it has {} frames, but {} times and {} numbers of contacts", frames_found,
                         times.size(), contacts.size()));
    for (std::size_t frame = 0; frame < times.size() && times[frame] <= time; ++frame) {
      if (contacts[frame] <= 0)
        refuse(fmt::format("frame {} has {} contacts", frame, contacts[frame]));
      extent_ = extended(extent_, static_cast<std::uint64_t>(contacts[frame]));
      last_time_ = times[frame];
    }
    for (const Growing& dataset : filled().datasets)
      if (root.shape(dataset.name).rows < dataset.rows)
        refuse(fmt::format("dataset {} has {} rows, expected {} or more", dataset.name,
                           root.shape(dataset.name).rows, dataset.rows));
    // Reading nothing checks the type.
    if (precision_ == Precision::double_precision)
      vtk.read("PointData/gap", std::span<double>());
    else
      vtk.read("PointData/gap", std::span<float>());
  } catch (const h5::Error& error) {
    throw InputError(fmt::format("cannot continue {}", error.what()));
  }
  if (extent_.frames == 0 || extent_.frames == frames_found) return;
  file_.cut(filled(), [&](h5::Group root) {
    root.open_group("VTKHDF/Steps").write_attribute<std::int64_t>("NSteps", extent_.frames);
  });
}

template <class Real>
void ContactFrameWriter::write_frame(h5::Group vtk, double time,
                                     const std::vector<ContactRecord>& contacts) const {
  const std::uint64_t count = contacts.size();
  append_number(vtk, "NumberOfPoints", static_cast<std::int64_t>(count));
  scree::append(vtk, "Points", column<double>(contacts, [](const ContactRecord& c, auto& out) {
                  add_vector(c.point, out);
                }));
  for (const char* name : topologies) {
    h5::Group topology = vtk.open_group(name);
    const std::uint64_t cells = name == topologies[0] ? count : 0;
    append_number(topology, "NumberOfCells", static_cast<std::int64_t>(cells));
    append_number(topology, "NumberOfConnectivityIds", static_cast<std::int64_t>(cells));
    scree::append(topology, "Offsets", counting(0, cells + 1));
    if (cells > extent_.most)
      scree::append(topology, "Connectivity", counting(extent_.most, cells));
  }

  h5::Group data = vtk.open_group("PointData");
  const double per_second = 1 / time_step_;
  scree::append(data, "normal", column<Real>(contacts, [](const ContactRecord& c, auto& out) {
                  add_vector(c.normal, out);
                }));
  scree::append(data, "force", column<Real>(contacts, [&](const ContactRecord& c, auto& out) {
                  add_vector(per_second * c.impulse, out);
                }));
  scree::append(data, "force_magnitude",
                column<Real>(contacts, [&](const ContactRecord& c, auto& out) {
                  out.push_back(static_cast<Real>(per_second * norm(c.impulse)));
                }));
  scree::append(data, "gap", column<Real>(contacts, [](const ContactRecord& c, auto& out) {
                  out.push_back(static_cast<Real>(c.gap));
                }));
  scree::append(data, "body_a", column<std::int32_t>(contacts, [](const auto& c, auto& out) {
                  out.push_back(c.body_a);
                }));
  scree::append(data, "body_b", column<std::int32_t>(contacts, [](const auto& c, auto& out) {
                  out.push_back(c.body_b);
                }));

  h5::Group steps = vtk.open_group("Steps");
  const auto first_point = static_cast<std::int64_t>(extent_.points);
  steps.append("Values", std::span<const double>(&time, 1));
  append_number(steps, "PartOffsets", extent_.frames);
  append_number(steps, "NumberOfParts", 1);
  append_number(steps, "PointOffsets", first_point);
  const std::array<std::int64_t, topologies.size()> first_cell{first_point};
  const std::array<std::int64_t, topologies.size()> first_connectivity{};
  steps.append("CellOffsets", std::span<const std::int64_t>(first_cell));
  steps.append("ConnectivityIdOffsets", std::span<const std::int64_t>(first_connectivity));
  h5::Group offsets = steps.open_group("PointDataOffsets");
  for (const std::string& name : data_names()) append_number(offsets, name, first_point);
  steps.write_attribute<std::int64_t>("NSteps", extent_.frames + 1);
}

void ContactFrameWriter::append(double time, const std::vector<ContactRecord>& contacts) {
  if (contacts.empty() || (last_time_ && time == *last_time_)) return;
  if (last_time_ && time < *last_time_)
    throw RunError(fmt::format("frame at {} s comes after the one at {} s", time, *last_time_));
  file_.append(filled(), [&](h5::Group root) {
    if (precision_ == Precision::double_precision)
      write_frame<double>(root.open_group("VTKHDF"), time, contacts);
    else
      write_frame<float>(root.open_group("VTKHDF"), time, contacts);
  });
  extent_ = extended(extent_, contacts.size());
  last_time_ = time;
}

}  // namespace scree
