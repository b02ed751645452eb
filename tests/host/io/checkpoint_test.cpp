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

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same_bits(const WorldState& a, const WorldState& b) {
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(std::memcmp(&a.time, &b.time, sizeof a.time), 0);
  EXPECT_EQ(a.insertions_done, b.insertions_done);
  EXPECT_EQ(a.id, b.id);
  EXPECT_TRUE(same_bits(a.position, b.position));
  EXPECT_TRUE(same_bits(a.orientation, b.orientation));
  EXPECT_TRUE(same_bits(a.velocity, b.velocity));
  EXPECT_TRUE(same_bits(a.angular_velocity, b.angular_velocity));
  EXPECT_EQ(a.contact_key, b.contact_key);
  EXPECT_TRUE(same_bits(a.contact_impulse, b.contact_impulse));
  EXPECT_TRUE(same_bits(a.solver_memory, b.solver_memory));
}

/// Free bodies 3, 0 and 2 of scene_with(4, ...), with values that text formats tend to lose.
WorldState state_with(int contacts, int vectors_per_contact) {
  WorldState state;
  state.step = 123456789012;
  state.time = 0.1 + 0.2;
  state.insertions_done = 0xfedcba9876543210u;
  state.id = {3, 0, 2};
  for (int i = 0; i < 3; ++i) {
    state.position.push_back({1.0 / 3, -0.0, std::numeric_limits<double>::denorm_min()});
    state.orientation.push_back({std::sqrt(0.5), 0, std::sqrt(0.5), 1e-300});
    state.velocity.push_back({i * M_PI, -1e15, static_cast<double>(0.1f)});
    state.angular_velocity.push_back({std::nextafter(1.0, 2.0), i + 0.5, 0});
  }
  for (int c = 0; c < contacts; ++c) {
    state.contact_key.push_back(~0ull - static_cast<unsigned>(c));
    for (int v = 0; v < vectors_per_contact; ++v)
      state.contact_impulse.push_back({c + 0.1, v + 0.2, -0.0});
  }
  state.solver_memory = {1e-17, 42.0};
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
  void write_odd(const std::function<void(h5::Group&)>& fill) {
    h5::File h5 = h5::File::create(file, seal_bytes);
    {
      h5::Group root = h5.root();
      root.write_text_attribute("backend", "cpu");
      root.write_text_attribute("precision", "float");
      fill(root);
    }
    h5.close();
    write_seal(file, "scree checkpoint", checkpoint_format_version);
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
  write({}, "");
  expect_same_bits(read_checkpoint(file).state, {});
  EXPECT_EQ(read_checkpoint(file).scene_text, "");
  const std::string text(300000, 'x');  // larger than an HDF5 attribute may be
  write({}, text);
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
    EXPECT_EQ(particles.velocity[i], state.velocity[static_cast<std::size_t>(row[i])]);
  }
}

TEST_F(CheckpointTest, LeavesBodiesThatAreNoSpheresOutOfTheParticles) {
  Scene scene = test::scene_with(4, 0, 0);
  scene.bodies[2].shape.kind = shapes::Box::kind;
  write_checkpoint(file, state_with(0, 1), BodyConstants(scene), "", BackendKind::cpu,
                   Precision::single_precision);
  EXPECT_EQ(read_checkpoint_particles(file).position.size(), 2u);
  write({});
  EXPECT_THROW(read_checkpoint_particles(file), InputError);
}

TEST_F(CheckpointTest, RefusesFilesThatAreNotCheckpoints) {
  EXPECT_THAT(refusal(), HasSubstr("no such file"));
  EXPECT_THAT(refusal(), HasSubstr(file.string()));
  std::filesystem::create_directory(file);
  EXPECT_THAT(refusal(), HasSubstr("not a file"));
  std::filesystem::remove(file);
  test::put(file, "");
  EXPECT_THAT(refusal(), HasSubstr("expected a scree checkpoint of format version 1"));
  test::put(file, "x,y,z\n1,2,3\n");
  EXPECT_THAT(refusal(), HasSubstr("a file of another kind"));
  h5::File::create(file).close();
  EXPECT_THAT(refusal(), HasSubstr("an HDF5 file of another kind"));
}

TEST_F(CheckpointTest, RefusesAnotherFormatVersion) {
  write(state_with(2, 1));
  write_seal(file, "scree checkpoint", 7);
  EXPECT_THAT(refusal(),
              HasSubstr("format version 7; expected a scree checkpoint of format version 1"));
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

TEST_F(CheckpointTest, RefusesArraysThatDisagree) {
  for (const char* name : {"body/position", "body/orientation", "body/radius", "contact/impulse"}) {
    write_odd([&](h5::Group& root) {
      root.write_attribute<std::int64_t>("step", 1);
      root.write_attribute<double>("time", 1);
      root.write_attribute<std::uint64_t>("insertions_done", 0);
      root.write_text("scene", "{}");
      for (const char* group : {"body", "contact", "solver"}) root.create_group(group);
      const auto doubles = [&](const char* array, std::uint64_t columns) {
        const std::uint64_t rows = array == std::string(name) ? 3 : 2;  // one has a row too many
        const std::vector<double> zeros(rows * std::max<std::uint64_t>(columns, 1));
        root.write(array, std::span<const double>(zeros), columns);
      };
      root.write("body/id", std::span<const std::int32_t>(std::vector<std::int32_t>{0, 2}));
      doubles("body/position", 3);
      doubles("body/orientation", 4);
      doubles("body/velocity", 3);
      doubles("body/angular_velocity", 3);
      doubles("body/radius", 0);
      doubles("body/mass", 0);
      root.write("body/group", std::span<const std::int32_t>(std::vector<std::int32_t>{0, 0}));
      root.write("contact/key", std::span<const std::uint64_t>(std::vector<std::uint64_t>{5, 6}));
      doubles("contact/impulse", 3);
    });
    EXPECT_THAT(refusal(), HasSubstr(name));
    EXPECT_THAT(refusal(), HasSubstr("expected"));
  }
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
  EXPECT_THAT(refused_with([](WorldState& s) { s.contact_impulse.clear(); }),
              HasSubstr("contact/impulse has 0 rows, expected 2, or 4"));
  EXPECT_THAT(refused_with([](WorldState& s) { s.contact_impulse.resize(6); }),
              HasSubstr("contact/impulse has 6 rows"));
  EXPECT_THAT(refused_with([&](WorldState& s) { s.position[1].y = infinite; }),
              HasSubstr("body/position holds inf"));
  EXPECT_THAT(refused_with([](WorldState& s) { s.velocity[0].z = -1e27; }),
              HasSubstr("body/velocity holds -1e+27, expected finite numbers up to 1e+15"));
  EXPECT_THAT(refused_with([&](WorldState& s) { s.solver_memory[0] = nan; }),
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
    write({});
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("No such file or directory"));
  }
}

}  // namespace
}  // namespace scree
