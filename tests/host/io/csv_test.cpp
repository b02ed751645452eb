#include "host/io/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/scene/particle_table.h"
#include "tests/host/input_files.h"

namespace scree {
namespace {

using test::refusal;
using test::write_file;
using testing::StartsWith;

TEST(ParticleCsv, ReadsAllColumnsInAnyOrder) {
  const auto file = write_file(
      "p.csv",
      "# made by hand\r\n"
      "id, z, y, x, vx, vy, vz, radius, mass, qw, qx, qy, qz, wx, wy, wz, group, material\r\n"
      "\r\n"
      "7, 3, 2, 1, 4, 5, 6, 0.5, 2, 0, 1, 0, 0, 7, 8, +9, left, glass\r\n"
      "# in between\n"
      "8, 3, 2, 1, 4, 5, 6, 1e-1, 2, 0, 1, 0, 0, 7, 8, 9, right, glass");
  const ParticleTable table = read_particle_csv(file, 0);
  const ParticleSet& p = table.particles;
  ASSERT_EQ(p.position.size(), 2u);
  EXPECT_EQ(p.position[0], Vec3d(1, 2, 3));
  EXPECT_EQ(p.velocity[0], Vec3d(4, 5, 6));
  EXPECT_EQ(p.angular_velocity[0], Vec3d(7, 8, 9));
  EXPECT_EQ(p.orientation[0].x, 1);
  EXPECT_EQ(p.radius[0], 0.5);
  EXPECT_EQ(p.mass[0], 2);
  EXPECT_TRUE(p.density.uniform());
  EXPECT_EQ(table.groups, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(table.materials, (std::vector<std::string>{"glass"}));
  EXPECT_EQ(p.radius[1], 0.1);
  EXPECT_EQ(p.group[1], 1);
  EXPECT_EQ(p.material[1], 0);
}

TEST(ParticleCsv, MissingColumnsAreLeftToTheCaller) {
  const ParticleTable table =
      read_particle_csv(write_file("p.csv", "\xEF\xBB\xBFx,y,z\n1,2,3\n"), 0);
  ASSERT_EQ(table.particles.position.size(), 1u);
  EXPECT_TRUE(table.particles.radius.uniform());
  EXPECT_TRUE(table.particles.group.uniform());
  EXPECT_TRUE(table.particles.velocity.uniform());
}

struct BadTable {
  const char* name;
  const char* content;
  const char* message;  // after the file name
};
class BadParticleCsv : public testing::TestWithParam<BadTable> {};

TEST_P(BadParticleCsv, IsRefusedByName) {
  const auto file = write_file("p.csv", GetParam().content);
  EXPECT_THAT(refusal([&] { read_particle_csv(file, 0); }),
              StartsWith(file.string() + ": " + GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Csv, BadParticleCsv,
    testing::Values(
        BadTable{"Empty", "", "empty: the first line must name columns"},
        BadTable{"UnknownColumn", "x,y,z,speed\n",
                 "line 1: unknown column \"speed\". Known columns: x, y"},
        BadTable{"NoTable", "root:x:0:0:root:/root\nx,y,z\n",
                 "line 1: no table: names none of the known columns: x, y, z, vx"},
        BadTable{"ControlCharacters", "x,y,z,\x1b[2J\n",
                 "line 1: unknown column \"\\x1b[2J\". Known"},
        BadTable{"LongCell",
                 "x,y,z\n1,2,01234567890123456789012345678901234567890123456789\n1,2,"
                 "a3456789012345678901"
                 "2345678901234567890123456789\n",
                 "line 3, column \"z\": \"a345678901234567890123456789012345678901...\" is not "
                 "allowed"},
        BadTable{"ColumnTwice", "x,y,z,x\n", "line 1: column \"x\" is given twice"},
        BadTable{"MissingColumn", "x,y\n1,2\n", "column \"z\" is missing"},
        BadTable{"HalfAVector", "x,y,z,vx\n1,2,3,4\n", "column \"vy\" is missing"},
        BadTable{"NotANumber", "x,y,z\n# a\n1,2,3\n1,two,3\n",
                 "line 4, column \"y\": \"two\" is not allowed: must be a finite number"},
        BadTable{"NumberAndMore", "x,y,z\n1,2,3m\n", "line 2, column \"z\": \"3m\" is not allowed"},
        BadTable{"Nan", "x,y,z\n1,nan,3\n", "line 2, column \"y\": \"nan\" is not allowed"},
        BadTable{"Overflow", "x,y,z\n1,1e999,3\n",
                 "line 2, column \"y\": \"1e999\" is not allowed"},
        BadTable{"EmptyCell", "x,y,z\n1,,3\n", "line 2, column \"y\": \"\" is not allowed"},
        BadTable{"ShortRow", "x,y,z\n1,2\n", "line 2: 2 values, but the header names 3 columns"},
        BadTable{"LongRow", "x,y,z\n1,2,3,4\n", "line 2: 4 values, but the header names 3 columns"},
        BadTable{"Radius", "x,y,z,radius\n1,2,3,-1\n",
                 "line 2, column \"radius\": \"-1\" is not allowed: must be positive [m]"},
        BadTable{"Quaternion", "x,y,z,qw,qx,qy,qz\n1,2,3,1,1,0,0\n",
                 "line 2, column \"qw\": \"1\" is not allowed: qw, qx, qy, qz must be a unit "
                 "quaternion"},
        BadTable{"Group", "x,y,z,group\n1,2,3,\n",
                 "line 2, column \"group\": \"\" is not allowed: must be a name"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST(ParticleCsv, RefusesAMissingFile) {
  EXPECT_EQ(refusal([] { read_particle_csv("nowhere.csv", 0); }), "nowhere.csv: no such file");
}

TEST(MotionCsv, ReadsTimesPositionsAndOrientations) {
  Motion motion;
  read_motion_csv(write_file("m.csv", "time,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,1,2,3,0,0,1,0\n"),
                  motion);
  EXPECT_EQ(motion.times, (std::vector<double>{0, 1}));
  EXPECT_EQ(motion.positions.at(1), Vec3d(1, 2, 3));
  EXPECT_EQ(motion.orientations.at(1).y, 1);
}

TEST(MotionCsv, RefusesTimesThatDoNotIncreaseAndSingleRows) {
  Motion motion;
  const auto file = write_file("m.csv", "time,x,y,z\n1,0,0,0\n1,0,0,0\n");
  EXPECT_EQ(refusal([&] { read_motion_csv(file, motion); }),
            file.string() +
                ": line 3, column \"time\": \"1\" is not allowed: must be larger than the "
                "time before [s]");
  const auto single = write_file("n.csv", "time,x,y,z\n1,0,0,0\n");
  Motion other;
  EXPECT_THAT(refusal([&] { read_motion_csv(single, other); }),
              testing::HasSubstr("two rows or more"));
}

}  // namespace
}  // namespace scree
