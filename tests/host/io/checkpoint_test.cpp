#include "host/io/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "host/error.h"
#include "host/io/h5.h"
#include "host/io/seal.h"
#include "host/scene/particle_table.h"
#include "shapes/box.h"
#include "tests/host/io/output_fixtures.h"

namespace scree {
namespace {

using test::contents;
using test::ScratchDirectory;
using testing::HasSubstr;

void expect_same_bits(const WorldState& a, const WorldState& b) {
  EXPECT_EQ(a.dynamics, b.dynamics);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(std::memcmp(&a.time, &b.time, sizeof a.time), 0);
  EXPECT_EQ(a.insertions_done, b.insertions_done);
  ASSERT_EQ(a.arrays.size(), b.arrays.size());
  for (std::size_t k = 0; k < a.arrays.size(); ++k) {
    ASSERT_EQ(a.arrays[k].name, b.arrays[k].name);
    std::visit(
        [&](const auto& rows) {
          using Rows = std::decay_t<decltype(rows)>;
          ASSERT_TRUE(std::holds_alternative<Rows>(b.arrays[k].values)) << a.arrays[k].name;
          const Rows& others = std::get<Rows>(b.arrays[k].values);
          ASSERT_EQ(rows.size(), others.size()) << a.arrays[k].name;
          EXPECT_TRUE(rows.empty() ||
                      std::memcmp(rows.data(), others.data(), rows.size() * sizeof rows[0]) == 0)
              << a.arrays[k].name;
        },
        a.arrays[k].values);
  }
}

/// Free bodies 3, 0 and 2 of scene_with(4, ...), with values that text formats tend to lose.
WorldState state_with(int contacts, int vectors_per_contact) {
  WorldState state = test::empty_state();
  state.step = 123456789012;
  state.time = 0.1 + 0.2;
  state.insertions_done = 0xfedcba9876543210u;
  state.at<std::int32_t>("body/id") = {3, 0, 2};
  for (int i = 0; i < 3; ++i) {
    state.at<Vec3d>("body/position")
        .push_back({1.0 / 3, -0.0, std::numeric_limits<double>::denorm_min()});
    state.at<Quatd>("body/orientation").push_back({std::sqrt(0.5), 0, std::sqrt(0.5), 1e-300});
    state.at<Vec3d>("body/velocity").push_back({i * M_PI, -1e15, static_cast<double>(0.1f)});
    state.at<Vec3d>("body/angular_velocity").push_back({std::nextafter(1.0, 2.0), i + 0.5, 0});
  }
  for (int c = 0; c < contacts; ++c) {
    state.at<std::int32_t>("contact/body_a").push_back(c);
    state.at<std::int32_t>("contact/body_b").push_back(c % 2 == 0 ? -1 : c + 1);
    state.at<std::uint64_t>("contact/feature").push_back(~0ull - static_cast<unsigned>(c));
    for (int v = 0; v < vectors_per_contact; ++v)
      state.at<Vec3d>("contact/impulse").push_back({c + 0.1, v + 0.2, -0.0});
    if (vectors_per_contact == 1) state.at<std::int32_t>("contact/mark").push_back(c % 7);
  }
  if (contacts > 0)
    state.add("joint/impulse", std::vector<Vec3d>{{1.0 / 7, -0.0, 3}, {0, 1e-30, -2}});
  state.at<double>("solver/memory") = {1e-17, 42.0};
  return state;
}

class CheckpointTest : public testing::Test {
 protected:
  void write(const WorldState& state, const std::string& scene_text = "{\"name\": \"bed\"}") {
    write_checkpoint(file, state, BodyConstants(test::scene_with(4, 0, 0)), scene_text,
                     BackendKind::cuda, Precision::double_precision);
  }
  /// Message of the refusal to read the file.
  std::string refusal() {
    try {
      read_checkpoint(file);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "the checkpoint was read";
    return {};
  }
  /// Writes a checkpoint that is whole as a file, with any contents.
  void write_odd(const std::function<void(h5::Group&)>& fill, int version = 2) {
    h5::File h5 = h5::File::create(file, seal_bytes);
    {
      h5::Group root = h5.root();
      root.write_attribute<std::int32_t>("format_version", version);
      if (version > 1) root.write_text_attribute("dynamics", "rigid");
      root.write_text_attribute("backend", "cpu");
      root.write_text_attribute("precision", "float");
      fill(root);
    }
    h5.close();
    write_seal(file, "scree checkpoint", version);
  }

  ScratchDirectory directory;
  std::filesystem::path file = directory / "checkpoint.h5";
};

TEST_F(CheckpointTest, ComesBackBitForBit) {
  for (const int contacts : {0, 1, 1000}) {
    for (const int vectors : {1, 2}) {
      const WorldState state = state_with(contacts, vectors);
      write(state);
      const Checkpoint checkpoint = read_checkpoint(file);
      expect_same_bits(checkpoint.state, state);
      EXPECT_EQ(checkpoint.format_version, checkpoint_format_version);
      EXPECT_EQ(checkpoint.scene_text, "{\"name\": \"bed\"}");
      EXPECT_EQ(checkpoint.backend, BackendKind::cuda);
      EXPECT_EQ(checkpoint.precision, Precision::double_precision);
    }
  }
}

TEST_F(CheckpointTest, HoldsARunWithoutBodiesAndLongTexts) {
  write(test::empty_state(), "");
  expect_same_bits(read_checkpoint(file).state, test::empty_state());
  EXPECT_EQ(read_checkpoint(file).scene_text, "");
  const std::string text(300000, 'x');  // larger than an HDF5 attribute may be
  write(test::empty_state(), text);
  EXPECT_EQ(read_checkpoint(file).scene_text, text);
}

TEST_F(CheckpointTest, LeavesNoTemporaryFile) {
  write(state_with(2, 1));
  write(state_with(3, 1));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
}

TEST_F(CheckpointTest, GivesSpheresInTheOrderOfIds) {
  const WorldState state = state_with(0, 1);
  write(state);
  const ParticleSet particles = read_checkpoint_particles(file);
  ASSERT_EQ(particles.position.size(), 3u);  // body 1 is the floor
  const std::vector<int> ids{0, 2, 3};
  const std::vector<int> row{1, 2, 0};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(particles.radius[i], 0.1 + ids[i]);
    EXPECT_EQ(particles.mass[i], 2.0 + ids[i]);
    EXPECT_EQ(particles.velocity[i],
              state.at<Vec3d>("body/velocity")[static_cast<std::size_t>(row[i])]);
  }
}

TEST_F(CheckpointTest, LeavesBodiesThatAreNoSpheresOutOfTheParticles) {
  Scene scene = test::scene_with(4, 0, 0);
  scene.bodies[2].shape.kind = shapes::Box::kind;
  write_checkpoint(file, state_with(0, 1), BodyConstants(scene), "", BackendKind::cpu,
                   Precision::single_precision);
  EXPECT_EQ(read_checkpoint_particles(file).position.size(), 2u);
  write(test::empty_state());
  EXPECT_THROW(read_checkpoint_particles(file), InputError);
}

TEST_F(CheckpointTest, RefusesFilesThatAreNotCheckpoints) {
  EXPECT_THAT(refusal(), HasSubstr("no such file"));
  EXPECT_THAT(refusal(), HasSubstr(file.string()));
  std::filesystem::create_directory(file);
  EXPECT_THAT(refusal(), HasSubstr("not a file"));
  std::filesystem::remove(file);
  test::put(file, "");
  EXPECT_THAT(refusal(), HasSubstr("expected a scree checkpoint of format version 1 to 2"));
  test::put(file, "x,y,z\n1,2,3\n");
  EXPECT_THAT(refusal(), HasSubstr("a file of another kind"));
  h5::File::create(file).close();
  EXPECT_THAT(refusal(), HasSubstr("an HDF5 file of another kind"));
}

TEST_F(CheckpointTest, RefusesAnotherFormatVersion) {
  write(state_with(2, 1));
  write_seal(file, "scree checkpoint", 7);
  EXPECT_THAT(refusal(),
              HasSubstr("format version 7; expected a scree checkpoint of format version 1 to 2"));
}

TEST_F(CheckpointTest, RefusesATruncatedFileAtEveryLength) {
  write(state_with(20, 1));
  const std::uintmax_t size = std::filesystem::file_size(file);
  for (std::uintmax_t length = 0; length < size; length += 97) {
    write(state_with(20, 1));
    std::filesystem::resize_file(file, length);
    EXPECT_THROW(read_checkpoint(file), InputError) << "at " << length << " of " << size;
  }
}

TEST_F(CheckpointTest, RefusesAFileDamagedAnywhere) {
  const WorldState state = state_with(20, 1);
  write(state);
  const std::string good = contents(file);
  for (std::size_t byte = 0; byte < good.size(); byte += 13) {
    std::string bad = good;
    bad[byte] = static_cast<char>(bad[byte] ^ 0x10);
    test::put(file, bad);
    EXPECT_THROW(read_checkpoint(file), InputError) << "byte " << byte;
  }
}

TEST_F(CheckpointTest, NamesTheChecksumOfADamagedArray) {
  write(state_with(20, 1));
  std::string bytes = contents(file);
  const double third = 1.0 / 3;
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&third), 8));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 7] ^= static_cast<char>(0x80);  // the sign of one coordinate
  test::put(file, bytes);
  EXPECT_THAT(refusal(), HasSubstr("checksum"));
}

/// Writes two bodies and two contacts; the array of the given name has a row too many.
void write_arrays(h5::Group& root, const std::string& odd, int version) {
  root.write_attribute<std::int64_t>("step", 1);
  root.write_attribute<double>("time", 1);
  root.write_attribute<std::uint64_t>("insertions_done", 0);
  root.write_text("scene", "{}");
  for (const char* group : {"body", "contact", "solver"}) root.create_group(group);
  const auto rows = [&](const std::string& name) { return odd == name ? 3u : 2u; };
  const auto doubles = [&](const char* name, std::uint64_t columns) {
    const std::vector<double> zeros(rows(name) * std::max<std::uint64_t>(columns, 1));
    root.write(name, std::span<const double>(zeros), columns);
  };
  const auto integers = [&](const char* name) {
    const std::vector<std::int32_t> zeros(rows(name));
    root.write(name, std::span<const std::int32_t>(zeros));
  };
  const auto keys = [&](const char* name) {
    const std::vector<std::uint64_t> values(rows(name), 5);
    root.write(name, std::span<const std::uint64_t>(values));
  };
  root.write("body/id", std::span<const std::int32_t>(std::vector<std::int32_t>{0, 2}));
  doubles("body/position", 3);
  doubles("body/orientation", 4);
  doubles("body/velocity", 3);
  doubles("body/angular_velocity", 3);
  doubles("body/radius", 0);
  doubles("body/mass", 0);
  integers("body/group");
  if (version == 1) {
    keys("contact/key");
  } else {
    integers("contact/body_a");
    integers("contact/body_b");
    keys("contact/feature");
    integers("contact/mark");
  }
  doubles("contact/impulse", 3);
  doubles("solver/memory", 0);
}

TEST_F(CheckpointTest, RefusesArraysThatDisagree) {
  for (const char* name : {"body/position", "body/orientation", "body/radius", "contact/body_b",
                           "contact/feature", "contact/impulse", "contact/mark"}) {
    write_odd([&](h5::Group& root) { write_arrays(root, name, 2); });
    EXPECT_THAT(refusal(), HasSubstr(name));
    EXPECT_THAT(refusal(), HasSubstr("expected"));
  }
}

TEST_F(CheckpointTest, ReadsTheFirstVersion) {
  write_odd([&](h5::Group& root) { write_arrays(root, "", 1); }, 1);
  const Checkpoint checkpoint = read_checkpoint(file);
  EXPECT_EQ(checkpoint.format_version, 1);
  EXPECT_EQ(checkpoint.state.dynamics, "rigid");
  EXPECT_EQ(checkpoint.state.at<std::int32_t>("body/id"), (std::vector<std::int32_t>{0, 2}));
  EXPECT_EQ(checkpoint.state.at<std::uint64_t>("contact/key").size(), 2u);
  EXPECT_FALSE(checkpoint.state.has("contact/body_a"));
  write_odd([&](h5::Group& root) { write_arrays(root, "contact/impulse", 1); }, 1);
  EXPECT_THAT(refusal(), HasSubstr("contact/impulse has 3 rows, expected 2 or 4"));
}

TEST_F(CheckpointTest, RefusesAModelThatIsNotThere) {
  WorldState state = state_with(2, 1);
  state.dynamics = "strings";
  write(state);
  EXPECT_THAT(refusal(),
              HasSubstr("attribute dynamics is \"strings\", which this program does not have"));
}

TEST_F(CheckpointTest, RefusesNumbersThatNoRunWrites) {
  const auto refused_with = [&](auto spoil) {
    WorldState state = state_with(2, 1);
    spoil(state);
    write(state);
    return refusal();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refused_with([](WorldState& s) { s.step = std::int64_t{1} << 63; }),
              HasSubstr("attribute step is -9223372036854775808, expected 0 to"));
  EXPECT_THAT(refused_with([](WorldState& s) { s.step = INT64_MAX; }), HasSubstr("step"));
  EXPECT_THAT(refused_with([&](WorldState& s) { s.time = nan; }), HasSubstr("time is nan"));
  EXPECT_THAT(refused_with([](WorldState& s) { s.at<Vec3d>("contact/impulse").clear(); }),
              HasSubstr("contact/impulse has 0 rows, expected 2 or 4"));
  EXPECT_THAT(refused_with([](WorldState& s) { s.at<Vec3d>("contact/impulse").resize(6); }),
              HasSubstr("contact/impulse has 6 rows"));
  EXPECT_THAT(refused_with([&](WorldState& s) { s.at<Vec3d>("body/position")[1].y = infinite; }),
              HasSubstr("body/position holds inf"));
  EXPECT_THAT(refused_with([](WorldState& s) { s.at<Vec3d>("body/velocity")[0].z = -1e27; }),
              HasSubstr("body/velocity holds -1e+27, expected finite numbers up to 1e+15"));
  EXPECT_THAT(refused_with([&](WorldState& s) { s.at<double>("solver/memory")[0] = nan; }),
              HasSubstr("solver/memory holds nan"));
}

TEST_F(CheckpointTest, RefusesAMissingDatasetByName) {
  write_odd([](h5::Group&) {});
  EXPECT_THAT(refusal(), HasSubstr("/scene: no such dataset"));
}

TEST_F(CheckpointTest, KeepsThePreviousOneWhenTheDiskIsFull) {
  const WorldState small = state_with(2, 1);
  write(small);
  const int code = test::with_full_disk(100000, [&] {
    try {
      write(state_with(20000, 1));
    } catch (const RunError& error) {
      const std::string what = error.what();
      return what.find(file.string()) != std::string::npos &&
                     what.find("the previous checkpoint is kept") != std::string::npos
                 ? 1
                 : 3;
    }
    return 0;
  });
  EXPECT_EQ(code, 1);
  expect_same_bits(read_checkpoint(file).state, small);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
}

TEST_F(CheckpointTest, NamesTheReasonWhenTheDirectoryIsNotThere) {
  file = directory / "missing" / "checkpoint.h5";
  try {
    write(test::empty_state());
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("No such file or directory"));
  }
}

}  // namespace
}  // namespace scree
