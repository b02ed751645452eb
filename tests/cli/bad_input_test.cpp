// What a user gets for bad input: one line that says what is wrong and where, exit code 2,
// nothing on disk.

#include <functional>
#include <map>
#include <ostream>

#include "host/io/checkpoint.h"
#include "host/io/h5.h"
#include "host/io/seal.h"
#include "host/scene_reader.h"
#include "tests/cli/program.h"
#include "tests/urdf_support.h"

namespace scree::test {
namespace {

using nlohmann::json;

/// One clear refusal: the given words, in one line.
void expect_refusal(const Result& result, const std::vector<std::string>& words, int code = 2) {
  EXPECT_EQ(result.code, code) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(line_count(result.err), 1u) << result.err;
  EXPECT_TRUE(result.err.starts_with("scree: ")) << result.err;
  for (const std::string& word : words)
    EXPECT_NE(result.err.find(word), std::string::npos) << "\"" << word << "\" in: " << result.err;
}

// ---- scenes ------------------------------------------------------------------------------------

/// A scene with one fault.
struct BadScene {
  std::string name;
  std::function<void(json&)> spoil;
  std::vector<std::string> words;  ///< that the message must hold, beside the scene's file name
};

json wall(const char* text) { return json::parse(text); }

const std::vector<BadScene>& bad_scenes() {
  static const std::vector<BadScene> all{
      {"UnknownKey",
       [](json& s) {
         s["solver"] = {{"iterations", 5}};
       },
       {"solver.iterations", "unknown key", "max_iterations"}},
      {"UnknownSolver",
       [](json& s) {
         s["solver"] = {{"name", "apgdd"}};
       },
       {"solver.name", "\"apgdd\"", "\"gauss_seidel_colored\"", "did you mean \"apgd\""}},
      {"WrongType",
       [](json& s) { s["time_step"] = "1 ms"; },
       {"time_step", "\"1 ms\"", "must be positive [s]"}},
      {"ZeroTimeStep",
       [](json& s) { s["time_step"] = 0; },
       {"time_step", "0 is not allowed", "positive"}},
      {"NegativeTimeStep",
       [](json& s) { s["time_step"] = -0.5; },
       {"time_step", "-0.5 is not allowed", "positive"}},
      {"MissingTimeStep", [](json& s) { s.erase("time_step"); }, {"time_step", "missing"}},
      {"NegativeRadius",
       [](json& s) { s["particles"][1]["radius"] = -0.5; },
       {"particles[1].radius", "-0.5 is not allowed", "positive [m]"}},
      {"NegativeMass",
       [](json& s) {
         s["bodies"].push_back(wall(R"({"shape": "sphere", "radius": 0.01, "mass": -2})"));
       },
       {"bodies[3].mass", "-2 is not allowed", "positive [kg]"}},
      {"NoMass",
       [](json& s) { s["bodies"].push_back(wall(R"({"shape": "sphere", "radius": 0.01})")); },
       {"bodies[3].density", "missing"}},
      {"NegativeFriction",
       [](json& s) { s["materials"]["m"]["friction"] = -0.1; },
       {"materials.m.friction", "-0.1 is not allowed", "zero or positive"}},
      {"UnknownMaterial",
       [](json& s) { s["bodies"][0]["material"] = "mm"; },
       {"bodies[0].material", "\"mm\" is not allowed", "did you mean \"m\""}},
      {"NoBodies",
       [](json& s) {
         s.erase("bodies");
         s.erase("particles");
       },
       {"bodies", "must hold one free body or more"}},
      {"OnlyWalls",
       [](json& s) { s.erase("particles"); },
       {"bodies", "must hold one free body or more"}},
      {"TooManySpheres",
       [](json& s) { s["particles"][0]["count"] = 100000; },
       {"particles[0].count", "100000 is not allowed"}},
      {"MeshMissing",
       [](json& s) { s["bodies"].push_back(wall(R"({"shape": "mesh", "file": "no.obj"})")); },
       {"bodies[3].file", "no.obj", "no such file"}},
      {"MeshOpen",
       [](json& s) { s["bodies"].push_back(wall(R"({"shape": "mesh", "file": "open.obj"})")); },
       {"open.obj", "closed"}},
      {"MeshDegenerate",
       [](json& s) {
         s["bodies"].push_back(
             wall(R"({"shape": "mesh", "file": "degenerate.obj", "closed": false})"));
       },
       {"degenerate.obj", "triangle 0 is degenerate"}},
      {"HeightsRagged",
       [](json& s) {
         s["bodies"].push_back(wall(
             R"({"shape": "height_field", "extent": [1, 1], "heights": [[0, 0], [0, 0, 0]]})"));
       },
       {"bodies[3].heights[1]", "3 heights, but the rows before have 2"}},
      {"HeightsMissing",
       [](json& s) {
         s["bodies"].push_back(
             wall(R"({"shape": "height_field", "extent": [1, 1], "file": "no.png"})"));
       },
       {"bodies[3].height_range", "missing"}},
      {"MeshFlat",
       [](json& s) { s["bodies"].push_back(wall(R"({"shape": "mesh", "file": "flat.obj"})")); },
       {"flat.obj", "encloses no volume"}},
      {"MeshThatCrossesItself",
       [](json& s) { s["bodies"].push_back(wall(R"({"shape": "mesh", "file": "crossing.obj"})")); },
       {"crossing.obj", "triangles 3 and 5 cross each other", "\"closed\": false"}},
      {"HullOfAPlane",
       [](json& s) {
         s["bodies"].push_back(wall(
             R"({"shape": "hull", "density": 1, "points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]]})"));
       },
       {"bodies[3].points", "one plane"}},
      {"HullOfAFlatFile",
       [](json& s) {
         s["bodies"].push_back(wall(R"({"shape": "hull", "density": 1, "file": "flat.obj"})"));
       },
       {"bodies[3].file", "flat.obj", "one plane"}},
      {"BoxWithoutThickness",
       [](json& s) {
         s["bodies"].push_back(wall(R"({"shape": "box", "density": 1, "size": [1, 0, 1]})"));
       },
       {"bodies[3].size", "[1,0,1] is not allowed", "positive"}},
      {"JointOfABodyWithItself",
       [](json& s) {
         s["joints"] = {wall(R"({"type": "ball", "bodies": [1, 1], "anchor": [0, 0, 0]})")};
       },
       {"joints[0].bodies", "the same body twice"}},
      {"JointWithoutAxis",
       [](json& s) {
         s["bodies"].push_back(wall(R"({"shape": "sphere", "radius": 0.01, "density": 1})"));
         s["joints"] = {wall(
             R"({"type": "hinge", "bodies": [3, "world"], "anchor": [0, 0, 0], "axis": [0, 0, 0]})")};
       },
       {"joints[0].axis", "[0,0,0] is not allowed"}},
      {"JointOfAnUnknownBody",
       [](json& s) {
         s["joints"] = {wall(R"({"type": "ball", "bodies": ["arm", 1], "anchor": [0, 0, 0]})")};
       },
       {"joints[0].bodies[0]", "\"arm\" is not allowed", "`name`"}},
      {"JointLimitsReversed",
       [](json& s) {
         s["bodies"].push_back(wall(R"({"shape": "sphere", "radius": 0.01, "density": 1})"));
         s["joints"] = {wall(R"({"type": "hinge", "bodies": [3, "world"], "anchor": [0, 0, 0],
                                 "axis": [0, 0, 1], "limits": [1, -1]})")};
       },
       {"joints[0].limits", "[1,-1] is not allowed"}},
      {"CsvBadRow",
       [](json& s) {
         s["particles"].push_back(wall(R"({"layout": "file", "file": "bad.csv", "density": 1})"));
       },
       {"bad.csv", "line 3", "\"x\""}},
      {"RegionBeyondAllNumbers",
       [](json& s) { s["particles"][0]["region"]["min"][0] = -1e30; },
       {"particles[0].count", "reaches 1e+30 m from the origin"}},
      {"RandomRegionBeyondAllNumbers",
       [](json& s) {
         s["particles"].push_back(wall(R"({"layout": "random", "count": 9, "radius": 0.01,
           "density": 1, "region": {"min": [-1e308, 0, 0], "max": [1e308, 1, 1]}})"));
       },
       {"particles[2].count", "reaches 1e+308 m from the origin"}},
      {"RainThatTimesCannotTell",
       [](json& s) { s["particles"][1]["start"] = 1e300; },
       {"particles[1].interval", "must be longer", "1e+300 s"}},
      {"FrictionBeyondAllNumbers",
       [](json& s) { s["materials"]["m"]["friction"] = 1e30; },
       {"materials.m.friction", "1e+30", "from 0 to 1e+06"}},
      {"EnvelopeBeyondAllNumbers",
       [](json& s) {
         s["collision"] = {{"envelope", 1e30}};
       },
       {"collision.envelope", "1e+30", "from 0 to 1e+15"}},
      {"SkinBeyondAllNumbers",
       [](json& s) {
         s["collision"] = {{"skin", 1e30}};
       },
       {"collision.skin", "1e+30", "from 0 to 1e+15"}},
      {"PeriodBeyondAllNumbers",
       [](json& s) {
         s["periodic"]["x"] = {0, 1e300};
       },
       {"periodic.x", "1e+300"}},
      {"RadiusBeyondAllNumbers",
       [](json& s) {
         s["bodies"].push_back(wall(R"({"shape": "sphere", "radius": 1e21, "density": 1})"));
       },
       {"bodies[3].radius", "1e+21", "from 1e-12 to 1e+15"}},
      {"PositionBeyondAllNumbers",
       [](json& s) {
         s["bodies"].push_back(
             wall(R"({"shape": "sphere", "radius": 1, "density": 1, "position": [0, 1e21, 0]})"));
       },
       {"bodies[3].position", "1e+21"}},
      {"SpeedBeyondAllNumbers",
       [](json& s) {
         s["particles"][0]["velocity"] = {0, 0, -1e27};
       },
       {"particles[0][0].velocity", "1e+27"}},
      {"MoreStepsThanCanBeCounted",
       [](json& s) { s["duration"] = 1e20; },
       {"duration", "1e+20", "1e+23 steps"}},
      {"SchemaThatIsNoText",
       [](json& s) { s["$schema"] = json::object(); },
       {"$schema", "{}", "must be a text"}},
      {"NameOfAFolderElsewhere",
       [](json& s) { s["name"] = "../elsewhere"; },
       {"name", "../elsewhere", "without slashes"}},
      {"NameThatSteersTheTerminal",
       [](json& s) { s["name"] = "a\x1b[2J"; },
       {"name", "a\\x1b[2J", "control characters"}},
      {"MoreMaterialsThanABodyCanName",
       [](json& s) {
         for (int i = 0; i < 300; ++i) s["materials"]["m" + std::to_string(i)] = json::object();
       },
       {"materials", "301", "256 or fewer"}},
      {"TableThatIsNone",
       [](json& s) {
         s["particles"].push_back(wall(R"({"layout": "file", "file": "open.obj", "density": 1})"));
       },
       {"open.obj", "line 1", "names none of the known columns"}},
      {"MotionOnAFreeBody",
       [](json& s) {
         s["bodies"][1]["kind"] = "free";
         s["bodies"][1]["density"] = 1000;
       },
       {"bodies[1].motion", "kinematic"}},
  };
  return all;
}

std::ostream& operator<<(std::ostream& out, const BadScene& s) { return out << s.name; }

class CliBadScene : public testing::TestWithParam<BadScene> {};

TEST_P(CliBadScene, IsRefused) {
  const Scratch scratch;
  put(scratch / "open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\n");
  put(scratch / "degenerate.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  put(scratch / "flat.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 2 1 4\nf 2 4 3\n");
  // Two tetrahedra, one through the other.
  put(scratch / "crossing.obj",
      "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
      "v 0.2 0.2 -1\nv 0.6 0.2 -1\nv 0.2 0.6 -1\nv 0.3 0.3 9\n"
      "f 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n");
  put(scratch / "bad.csv", "x,y,z,radius\n0,0,0.4,0.01\nx,0,0.4,0.01\n");
  json scene = small_scene();
  GetParam().spoil(scene);
  const fs::path file = put_scene(scratch, scene);
  for (const Arguments& command :
       {run_arguments(file, scratch / "a"), Arguments{"check", file.string()}})
    expect_refusal(scree(scratch, command), GetParam().words);
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

TEST(CliBadUrdf, IsRefusedByFileLineAndElement) {
  const Scratch scratch;
  json scene = small_scene();
  scene["urdf"] = {{{"file", "arm.urdf"}}};
  const fs::path file = put_scene(scratch, scene);
  put(scratch / "arm.urdf",
      "<robot name=\"arm\">\n<link name=\"a\"><inertial><mass "
      "value=\"-1\"/></inertial></link>\n</robot>");
  std::vector<std::string> words{file.string(), "urdf[0].file", "arm.urdf"};
  const std::vector<std::string> more =
      reads_urdf() ? std::vector<std::string>{"line 2", "link \"a\"", "value \"-1\"", "[kg]"}
                   : std::vector<std::string>{"tinyxml2", "libtinyxml2-dev"};
  words.insert(words.end(), more.begin(), more.end());
  for (const Arguments& command :
       {run_arguments(file, scratch / "a"), Arguments{"check", file.string()}})
    expect_refusal(scree(scratch, command), words);
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

/// Keys that are looked up one by one among all others made this a matter of minutes.
TEST(CliLongScene, AHundredThousandKeysAreReadAtOnce) {
  const Scratch scratch;
  std::string text = R"({"time_step": 1e-3, "duration": 0, "materials": {)";
  for (int i = 0; i < 100'000; ++i) text += "\"m" + std::to_string(i) + "\": {}, ";
  const fs::path many = put(scratch / "many.json", text + R"("last": {}}})");
  const fs::path twice = put(scratch / "twice.json", text + R"("m0": {}}})");
  const auto start = std::chrono::steady_clock::now();
  expect_refusal(scree(scratch, {"check", many.string()}), {"materials", "100001", "256"});
  expect_refusal(scree(scratch, {"check", twice.string()}), {"materials.m0", "given twice"});
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

INSTANTIATE_TEST_SUITE_P(Scenes, CliBadScene, testing::ValuesIn(bad_scenes()),
                         [](const auto& info) { return info.param.name; });

/// Text that is no scene at all, or holds a number that is none.
struct BadText {
  std::string name;
  std::string text;
  std::vector<std::string> words;
};

std::ostream& operator<<(std::ostream& out, const BadText& t) { return out << t.name; }

class CliBadText : public testing::TestWithParam<BadText> {};

TEST_P(CliBadText, IsRefused) {
  const Scratch scratch;
  const fs::path file = put(scratch / "scene.json", GetParam().text);
  std::vector<std::string> words = GetParam().words;
  words.push_back(file.string());
  expect_refusal(scree(scratch, run_arguments(file, scratch / "a")), words);
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

INSTANTIATE_TEST_SUITE_P(
    Texts, CliBadText,
    testing::Values(BadText{"Broken",
                            "{\n  \"time_step\": 1e-3,\n  \"duration\" 1\n}",
                            {"line 3, column 14", "syntax error"}},
                    BadText{"CutOff", "{\"time_step\": 1e-3,", {"line 1", "syntax error"}},
                    BadText{"Empty", "", {"line 1", "syntax error"}},
                    BadText{"NaN", "{\n\"time_step\": NaN}", {"line 2", "syntax error"}},
                    BadText{"TooLarge",
                            "{\"time_step\": 1e999, \"duration\": 1}",
                            {"time_step", "1e999", "finite"}},
                    BadText{
                        "KeyTwice", "{\"duration\": 1, \"duration\": 2}", {"duration", "twice"}},
                    BadText{"List", "[1, 2]", {"must be an object"}}),
    [](const auto& info) { return info.param.name; });

// ---- command line
// --------------------------------------------------------------------------------

struct BadCommand {
  std::string name;
  Arguments arguments;  ///< SCENE stands for a good scene
  std::vector<std::string> words;
};

std::ostream& operator<<(std::ostream& out, const BadCommand& c) { return out << c.name; }

class CliBadCommand : public testing::TestWithParam<BadCommand> {};

TEST_P(CliBadCommand, IsRefused) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  Arguments arguments = GetParam().arguments;
  std::replace(arguments.begin(), arguments.end(), std::string("SCENE"), scene.string());
  expect_refusal(scree(scratch, arguments), GetParam().words);
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

INSTANTIATE_TEST_SUITE_P(
    Commands, CliBadCommand,
    testing::Values(
        BadCommand{"NoCommand", {}, {"run, check, bench, solve, convert, info"}},
        BadCommand{"UnknownCommand",
                   {"rnu", "SCENE"},
                   {"rnu", "no such command", "run, check, bench, solve, convert, info"}},
        BadCommand{"UnknownOption", {"run", "SCENE", "--fast"}, {"--fast", "scree run --help"}},
        BadCommand{"UnknownMainOption", {"--fast"}, {"--fast"}},
        BadCommand{"NoScene", {"run"}, {"scene is required"}},
        BadCommand{"MissingScene", {"run", "piel"}, {"piel", "no such file", "pile"}},
        BadCommand{"SceneIsADirectory", {"run", "."}, {"is a directory"}},
        BadCommand{"NegativeSteps", {"run", "SCENE", "--steps", "-1"}, {"--steps", "-1"}},
        BadCommand{"WordForSteps", {"run", "SCENE", "--steps", "ten"}, {"--steps", "ten"}},
        BadCommand{"WordForThreads", {"run", "SCENE", "--threads", "x"}, {"--threads", "x"}},
        BadCommand{"UnknownBackend",
                   {"run", "SCENE", "--backend", "gpu"},
                   {"\"gpu\"", "cuda, cpu or auto"}},
        BadCommand{"NegativeDevice", {"run", "SCENE", "--device", "-1"}, {"--device", "-1"}},
        BadCommand{"DeviceOfTheCpu",
                   {"run", "SCENE", "--backend", "cpu", "--device", "0"},
                   {"--device 0", "backend cuda"}},
        BadCommand{"MissingDevice",  // with the devices that are there, or why there are none
                   {"check", "SCENE", "--backend", "cuda", "--device", "1023"},
                   {"--device 1023: "}},
        BadCommand{"MissingDeviceOfAuto",
                   {"bench", "SCENE", "--backend", "auto", "--device", "1023"},
                   {"--device 1023: "}},
        BadCommand{"UnknownPrecision",
                   {"run", "SCENE", "--precision", "half"},
                   {"\"half\"", "float or double"}},
        BadCommand{"SetWithoutValue",
                   {"run", "SCENE", "--set", "duration"},
                   {"\"duration\"", "key.path=value"}},
        BadCommand{"SetUnknownKey",
                   {"run", "SCENE", "--set", "foo.bar=1"},
                   {"foo", "overridden", "unknown key"}},
        BadCommand{"SetNoSuchElement",
                   {"run", "SCENE", "--set", "particles.7.count=1"},
                   {"particles.7.count=1", "from 0 to 1"}},
        BadCommand{"SetBadValue",
                   {"run", "SCENE", "--set", "particles.0.density=-1"},
                   {"particles[0].density (overridden)", "-1 is not allowed", "positive [kg/m^3]"}},
        BadCommand{"SetOutOfRange",
                   {"run", "SCENE", "--set", "gravity=[0,0,1e300]"},
                   {"scene.json: gravity (overridden)", "1e+300"}},
        BadCommand{
            "SolverWithoutJoints",
            {"check", "SCENE", "--set", "solver.name=schwarz", "--set",
             R"(bodies.1={"shape": "sphere", "radius": 0.01, "density": 1000, "position": [0, 0, 1]})",
             "--set", R"(joints=[{"type": "ball", "bodies": ["world", 1], "anchor": [0, 0, 1]}])"},
            {"scene.json: solver.name (overridden)", "\"schwarz\" is not allowed", "has joints"}},
        BadCommand{"NoMemory",
                   {"run", "SCENE", "--memory", "0"},
                   {"--memory", "0 is not allowed: must be above 0 and up to 1e+09 [MiB]"}},
        BadCommand{"SetInfinite",
                   {"run", "SCENE", "--set", "time_step=1e999"},
                   {"time_step (overridden)", "1e999"}},
        BadCommand{
            "ResumeAndForce", {"run", "SCENE", "--resume", "--force"}, {"--resume and --force"}},
        BadCommand{"ResumeOfNothing", {"run", "SCENE", "--resume"}, {"out/small", "no checkpoint"}},
        BadCommand{
            "BenchFromNothing", {"bench", "SCENE", "--from", "no.h5"}, {"no.h5", "no such file"}}),
    [](const auto& info) { return info.param.name; });

TEST(CliBadBackend, CudaWithoutAGpu) {
  const Scratch scratch;
  if (json::parse(scree(scratch, {"info", "--json"}).out).at("cuda").contains("name"))
    GTEST_SKIP() << "this machine has a GPU";
  const fs::path scene = put_scene(scratch, small_scene());
  expect_refusal(scree(scratch, {"run", scene.string(), "--backend", "cuda", "--out",
                                 (scratch / "a").string()}),
                 {"--backend cuda", "--backend cpu"});
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

// ---- output directory
// ------------------------------------------------------------------------------

class CliBadOutput : public testing::Test {
 protected:
  Result run(const fs::path& out, const Arguments& more = {}) {
    Arguments all = more;
    if (std::find(more.begin(), more.end(), "--steps") == more.end())
      all.insert(all.end(), {"--steps", "3"});
    return scree(scratch, run_arguments(scene, out, all));
  }
  /// A finished run of three steps in the folder a.
  void make_run() {
    const Result result = run(scratch / "a");
    ASSERT_EQ(result.code, 0) << result.err;
  }
  /// Everything in the folder a, to see that nothing of it was touched.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(scratch / "a"))
      all[entry.path().filename()] = contents(entry);
    return all;
  }

  Scratch scratch;
  fs::path scene = put_scene(scratch, small_scene());
};

TEST_F(CliBadOutput, ExistingResultsNeedForceOrResume) {
  make_run();
  const auto before = files();
  expect_refusal(run(scratch / "a"),
                 {(scratch / "a").string(), "not empty", "--resume", "--force"});
  EXPECT_EQ(files(), before);
}

TEST_F(CliBadOutput, File) {
  put(scratch / "a", "mine");
  expect_refusal(run(scratch / "a"), {(scratch / "a").string(), "not a directory"});
  expect_refusal(run(scratch / "a/b"), {(scratch / "a").string(), "not a directory"});
  EXPECT_EQ(contents(scratch / "a"), "mine");
}

TEST_F(CliBadOutput, WriteProtectedFolder) {
  if (::geteuid() == 0) {
    if (!fs::exists("/proc/self")) GTEST_SKIP() << "root may write everywhere here";
    expect_refusal(run("/proc/scree"), {"cannot create", "/proc/scree"});
    return;
  }
  fs::create_directory(scratch / "locked");
  fs::permissions(scratch / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  expect_refusal(run(scratch / "locked/a"), {"locked", "cannot be created"});
  fs::permissions(scratch / "locked", fs::perms::owner_all);
}

TEST_F(CliBadOutput, BadSceneLeavesEarlierResultsAlone) {
  make_run();
  const auto before = files();
  EXPECT_EQ(run(scratch / "a", {"--force", "--set", "time_step=-1"}).code, 2);
  EXPECT_EQ(files(), before);
}

TEST_F(CliBadOutput, ResumeOfAnotherScene) {
  make_run();
  const auto before = files();
  expect_refusal(run(scratch / "a", {"--resume", "--steps", "5", "--set", "gravity=[0, 0, -1]"}),
                 {(scratch / "a").string(), "another scene", "gravity", "[0,0,-1]"});
  expect_refusal(run(scratch / "a", {"--resume", "--steps", "5", "--precision", "double"}),
                 {"checkpoint.h5", "float", "double"});
  EXPECT_EQ(files(), before);
}

/// A damaged checkpoint is refused, and stays as it is.
class CliBadCheckpoint : public CliBadOutput {
 protected:
  fs::path checkpoint() const { return scratch / "a/checkpoint.h5"; }
  void expect_refused(const std::vector<std::string>& words) {
    const auto before = files();
    std::vector<std::string> all = words;
    all.push_back(checkpoint().string());
    expect_refusal(run(scratch / "a", {"--resume", "--steps", "5"}), all);
    EXPECT_EQ(files(), before);
  }
};

TEST_F(CliBadCheckpoint, Truncated) {
  make_run();
  fs::resize_file(checkpoint(), fs::file_size(checkpoint()) / 2);
  expect_refused({"bytes where"});
}

TEST_F(CliBadCheckpoint, NotHdf5) {
  make_run();
  put(checkpoint(), "something else\n");
  expect_refused({"another kind"});
}

TEST_F(CliBadCheckpoint, OneBitFlipped) {
  make_run();
  std::string bytes = contents(checkpoint());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  put(checkpoint(), bytes);
  expect_refused({"damaged"});
}

TEST_F(CliBadCheckpoint, AnotherVersion) {
  make_run();
  write_seal(checkpoint(), "scree checkpoint", checkpoint_format_version + 1);
  expect_refused({"format version " + std::to_string(checkpoint_format_version + 1),
                  "expected a scree checkpoint of format version 1 to " +
                      std::to_string(checkpoint_format_version)});
}

TEST_F(CliBadCheckpoint, Gone) {
  make_run();
  fs::remove(checkpoint());
  expect_refusal(run(scratch / "a", {"--resume"}),
                 {(scratch / "a").string(), "checkpoint.h5", "--force"});
}

TEST_F(CliBadCheckpoint, OfBodiesThatTheSceneDoesNotHave) {
  make_run();
  Checkpoint forged = read_checkpoint(checkpoint());
  forged.state.at<std::int32_t>("body/id").front() = 0;  // the container
  forged.state.step = 1;
  forged.state.time = 1e-3;
  write_checkpoint(checkpoint(), forged.state, BodyConstants(read_scene(scene)), forged.scene_text,
                   forged.backend, forged.precision);
  expect_refused({"body 0 is not a free body of the scene"});
}

TEST_F(CliBadCheckpoint, OfAnotherSceneInABenchmark) {
  make_run();
  expect_refusal(scree(scratch, {"bench", "scene", scene.string(), "--set", "particles.0.count=20",
                                 "--backend", "cpu", "--from", checkpoint().string()}),
                 {checkpoint().string(), "free bodies"});
}

TEST_F(CliBadOutput, ResumeOfATableThatIsNotOne) {
  make_run();
  const fs::path table = scratch / "a/steps.csv";
  std::string text = contents(table);
  put(table, text.replace(text.find("bodies"), 6, "badies"));
  const auto before = files();
  expect_refusal(run(scratch / "a", {"--resume", "--steps", "5"}),
                 {table.string(), "line 1", "badies", "bodies"});
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace scree::test
