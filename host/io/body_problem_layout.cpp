#include "host/io/body_problem_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <type_traits>

#include "host/error.h"
#include "host/io/values.h"

namespace scree {
namespace {

// Rows of arrays are these types, read and written as they lie in memory.
static_assert(sizeof(Twist<double>) == 6 * sizeof(double));
static_assert(sizeof(RollingRow<double>) == 3 * sizeof(double));
static_assert(sizeof(Sym3<double>) == 6 * sizeof(double));

template <class T>
std::uint64_t columns_of() {
  if constexpr (std::is_same_v<T, double>) {
    return 0;
  } else {
    return sizeof(T) / sizeof(double);
  }
}

/// What an array with so many columns has a row; 0: one dimension.
std::string rows_text(std::uint64_t columns) {
  return columns == 0 ? "one dimension" : fmt::format("two dimensions, rows of {}", columns);
}

template <class T>
void write_rows(h5::Group& group, const char* name, const std::vector<T>& rows) {
  group.write(name,
              std::span<const double>(reinterpret_cast<const double*>(rows.data()),
                                      rows.size() * std::max<std::uint64_t>(1, columns_of<T>())),
              columns_of<T>());
}

template <class T>
std::vector<T> read_rows(const h5::Group& group, const char* name) {
  const h5::Shape shape = group.shape(name);
  if (shape.columns != columns_of<T>())
    throw InputError(fmt::format("{} is an array of {}, expected {}", name,
                                 rows_text(shape.columns), rows_text(columns_of<T>())));
  const std::vector<double> values = group.read_converted<double>(name);
  std::vector<T> rows(shape.rows);
  std::copy(values.begin(), values.end(), reinterpret_cast<double*>(rows.data()));
  return rows;
}

std::vector<std::int32_t> read_indices(const h5::Group& group, const char* name) {
  const auto stored = group.read_converted<std::int64_t>(name);
  std::vector<std::int32_t> indices;
  indices.reserve(stored.size());
  for (std::size_t k = 0; k < stored.size(); ++k) {
    if (stored[k] < -1 || stored[k] > std::numeric_limits<std::int32_t>::max())
      throw InputError(fmt::format("{}[{}] is {}, expected an index", name, k, stored[k]));
    indices.push_back(static_cast<std::int32_t>(stored[k]));
  }
  return indices;
}

void write_rows(h5::Group& group, const char* name, const std::vector<std::int32_t>& indices) {
  group.write(name, std::span<const std::int32_t>(indices));
}

template <class T>
void read_field(const h5::Group& group, const char* name, std::vector<T>& values) {
  values = read_rows<T>(group, name);
}
void read_field(const h5::Group& group, const char* name, std::vector<std::int32_t>& values) {
  values = read_indices(group, name);
}

/// Writes one member of every body.
template <class Record, class Member>
void write_member(h5::Group& group, const char* name, const std::vector<Record>& records,
                  Member Record::*member) {
  std::vector<Member> values;
  values.reserve(records.size());
  for (const Record& r : records) values.push_back(r.*member);
  write_rows(group, name, values);
}

/// Reads one member of every body; all must have as many rows.
template <class Record, class Member>
void read_member(const h5::Group& group, const char* name, std::vector<Record>& records,
                 Member Record::*member) {
  const std::vector<Member> values = read_rows<Member>(group, name);
  if (values.size() != records.size())
    throw InputError(fmt::format("{} has {} rows, expected {} (one a body)", name, values.size(),
                                 records.size()));
  for (std::size_t k = 0; k < values.size(); ++k) records[k].*member = values[k];
}

/// Member by member, f(name of the dataset, member).
template <class F>
void each_bilateral_vector(F f) {
  f("arm_a", &BilateralRow::arm_a);
  f("arm_b", &BilateralRow::arm_b);
  f("force", &BilateralRow::force);
  f("moment", &BilateralRow::moment);
  f("bias", &BilateralRow::bias);
}

void read_bilateral(const h5::Group& root, std::vector<BilateralRow>& rows) {
  const std::vector<std::int32_t> body_a = read_indices(root, "bilateral/body_a");
  const std::vector<std::int32_t> body_b = read_indices(root, "bilateral/body_b");
  if (body_a.size() != body_b.size())
    throw InputError(fmt::format("bilateral/body_b has {} rows, expected {} (as bilateral/body_a)",
                                 body_b.size(), body_a.size()));
  rows.resize(body_a.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].body_a = body_a[k];
    rows[k].body_b = body_b[k];
  }
  const auto read = [&](const std::string& name, auto member) {
    using Member = std::remove_reference_t<decltype(rows[0].*member)>;
    const std::vector<Member> values = read_rows<Member>(root, name.c_str());
    if (values.size() != rows.size())
      throw InputError(fmt::format("{} has {} rows, expected {} (one a bilateral row)", name,
                                   values.size(), rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].*member = values[k];
  };
  each_bilateral_vector(
      [&](const char* name, auto member) { read(std::string("bilateral/") + name, member); });
  read("warm_start/bilateral", &BilateralRow::impulse);
}

void write_bilateral(h5::Group& root, h5::Group& warm_start,
                     const std::vector<BilateralRow>& rows) {
  h5::Group group = root.create_group("bilateral");
  write_member(group, "body_a", rows, &BilateralRow::body_a);
  write_member(group, "body_b", rows, &BilateralRow::body_b);
  each_bilateral_vector(
      [&](const char* name, auto member) { write_member(group, name, rows, member); });
  write_member(warm_start, "bilateral", rows, &BilateralRow::impulse);
}

ContactLayout read_layout(const h5::Group& root) {
  const std::string word = root.text_attribute("layout");
  for (const ContactLayout layout :
       {ContactLayout::radial, ContactLayout::general, ContactLayout::rolling})
    if (word == to_string(layout)) return layout;
  throw InputError(
      fmt::format("attribute layout is \"{}\", expected radial, general or rolling", word));
}

void write_source(h5::Group& root, const ProblemSource& s) {
  root.write_text_attribute("scene", s.scene);
  root.write_text_attribute("program", s.program);
  root.write_text_attribute("backend", s.backend);
  root.write_text_attribute("precision", s.precision);
  root.write_attribute<std::int64_t>("step", s.step);
  root.write_attribute<double>("time", s.time);
  root.write_attribute<double>("time_step", s.time_step);
  root.write_attribute<double>("reference_speed", s.reference_speed);
}

ProblemSource read_source(const h5::Group& root) {
  ProblemSource s;
  s.scene = root.text_attribute("scene");
  s.program = root.text_attribute("program");
  s.backend = root.text_attribute("backend");
  s.precision = root.text_attribute("precision");
  s.step = root.attribute<std::int64_t>("step");
  s.time = root.attribute<double>("time");
  s.time_step = root.attribute<double>("time_step");
  s.reference_speed = root.attribute<double>("reference_speed");
  return s;
}

}  // namespace

bool is_body_problem(const h5::Group& root) {
  return root.has_attribute("format") && root.text_attribute("format") == problem_format_name;
}

BodyProblem read_body_problem(const h5::Group& root) {
  const auto version = root.attribute<std::int64_t>("format_version");
  if (version != problem_format_version && version != bilateral_version)
    throw InputError(fmt::format("attribute format_version is {}, expected {} or {}", version,
                                 problem_format_version, bilateral_version));
  BodyProblem p;
  p.layout = read_layout(root);
  p.source = read_source(root);
  const auto free_count = root.attribute<std::int64_t>("free_count");
  if (free_count < 0 || free_count > std::numeric_limits<std::int32_t>::max())
    throw InputError(fmt::format("attribute free_count is {}, expected a count", free_count));
  p.free_count = static_cast<int>(free_count);

  p.body_id = read_indices(root, "body/id");
  p.free_velocity = read_rows<Twist<double>>(root, "body/free_velocity");
  if (p.layout == ContactLayout::radial) {
    p.radial_inertia.resize(p.free_velocity.size());
    read_member(root, "body/inv_mass", p.radial_inertia, &RadialInertia<double>::inv_mass);
    read_member(root, "body/inv_spin", p.radial_inertia, &RadialInertia<double>::inv_spin);
  } else {
    p.general_inertia.resize(p.free_velocity.size());
    read_member(root, "body/mass", p.general_inertia, &GeneralInertia<double>::mass);
    read_member(root, "body/inv_mass", p.general_inertia, &GeneralInertia<double>::inv_mass);
    read_member(root, "body/inertia", p.general_inertia, &GeneralInertia<double>::inertia);
    read_member(root, "body/inv_inertia", p.general_inertia, &GeneralInertia<double>::inv_inertia);
  }

  const ContactParts parts = stored_parts(p.layout);
  p.visit(
      [&](const ContactField& field, auto& values) {
        const std::string path = std::string("contact/") + field.name;
        if (field.is_optional ? root.has(path) : parts.*field.part)
          read_field(root, path.c_str(), values);
      },
      p);
  p.impulse = read_rows<Vec3d>(root, "warm_start/impulse");
  if (version >= bilateral_version) read_bilateral(root, p.bilateral);
  return p;
}

void write_body_problem(h5::Group& root, const BodyProblem& p) {
  root.write_text_attribute("format", problem_format_name);
  root.write_attribute<std::int64_t>(
      "format_version", p.bilateral.empty() ? problem_format_version : bilateral_version);
  root.write_text_attribute("layout", to_string(p.layout));
  root.write_attribute<std::int64_t>("free_count", p.free_count);
  write_source(root, p.source);

  h5::Group body = root.create_group("body");
  write_rows(body, "id", p.body_id);
  write_rows(body, "free_velocity", p.free_velocity);
  if (p.layout == ContactLayout::radial) {
    write_member(body, "inv_mass", p.radial_inertia, &RadialInertia<double>::inv_mass);
    write_member(body, "inv_spin", p.radial_inertia, &RadialInertia<double>::inv_spin);
  } else {
    write_member(body, "mass", p.general_inertia, &GeneralInertia<double>::mass);
    write_member(body, "inv_mass", p.general_inertia, &GeneralInertia<double>::inv_mass);
    write_member(body, "inertia", p.general_inertia, &GeneralInertia<double>::inertia);
    write_member(body, "inv_inertia", p.general_inertia, &GeneralInertia<double>::inv_inertia);
  }

  h5::Group contact = root.create_group("contact");
  const ContactParts parts = stored_parts(p.layout);
  p.visit(
      [&](const ContactField& field, const auto& values) {
        if (field.is_optional ? !values.empty() : parts.*field.part)
          write_rows(contact, field.name, values);
      },
      p);
  h5::Group warm_start = root.create_group("warm_start");
  write_rows(warm_start, "impulse", p.impulse);
  if (!p.bilateral.empty()) write_bilateral(root, warm_start, p.bilateral);
}

}  // namespace scree
