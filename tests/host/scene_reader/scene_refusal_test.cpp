// Scenes that are refused_text: file, key path, value and expectation, word by word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/scene_reader.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using test::parsed;
using test::refusal;
using test::with_body;
using test::with_particles;
using test::with_sphere;
using test::write_file;
using testing::StartsWith;

std::string refused_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return refusal([&] { parsed(text, overrides); });
}

struct RefusedValue {
  const char* what;  // name of the case
  std::string text;
  std::string message;  // start of the message after "x.json: "
};
class SceneRefusal : public testing::TestWithParam<RefusedValue> {};

TEST_P(SceneRefusal, NamesPathValueAndExpectation) {
  EXPECT_THAT(refused_text(GetParam().text), StartsWith("x.json: " + GetParam().message));
}

const std::string kLattice = R"("layout": "lattice", "density": 1000, "radius": 0.1, )";
const std::string kUnitBox = R"("region": {"min": [0, 0, 0], "max": [1, 1, 1]})";

INSTANTIATE_TEST_SUITE_P(
    Json, SceneRefusal,
    testing::Values(
        RefusedValue{"Comma", "{\"time_step\": 1,\n \"duration\": 1,, }",
                     "line 2, column 16: syntax error"},
        RefusedValue{"Empty", "", "line 1, column 1: syntax error"},
        RefusedValue{"Truncated", "{\"time_step\": 1", "line 1, column 15: syntax error"},
        RefusedValue{"Overflow", "{\"time_step\": 1,\n\"bodies\": [{}, {\"radius\": 1e999}]}",
                     "bodies[1].radius: 1e999 is not allowed: must be a finite number (line 2)"},
        RefusedValue{"Twice", R"({"bodies": [{"mass": 1, "mass": 2}]})",
                     "bodies[0].mass: this key is given twice"},
        RefusedValue{"NotAnObject", "[1]", "document: [1] is not allowed: must be an object {...}"},
        RefusedValue{"Deep", std::string(1000, '['), "more than 100 lists"}),
    [](const auto& one) { return std::string(one.param.what); });

INSTANTIATE_TEST_SUITE_P(
    Sizes, SceneRefusal,
    testing::Values(
        RefusedValue{
            "Capsule",
            with_body(R"({"shape": "capsule", "radius": 1, "length": 1e-17, "density": 1})"),
            "bodies[1]: radius 1, length 1e-17 is not allowed: "},
        RefusedValue{
            "Cylinder",
            with_body(R"({"shape": "cylinder", "radius": 1e-13, "length": 1, "density": 1})"),
            "bodies[1]: radius 1e-13, length 1 is not allowed: "},
        RefusedValue{"Box", with_body(R"({"shape": "box", "size": [1, 1e-13, 1], "density": 1})"),
                     "bodies[1]: size [1,1e-13,1] is not allowed: "},
        RefusedValue{"Container",
                     with_body(R"({"shape": "container", "min": [0, 0, 0], "max": [1, 1, 1e-13]})"),
                     "bodies[1]: min [0,0,0], max [1,1,1e-13] is not allowed: "}),
    [](const auto& one) { return std::string(one.param.what); });

INSTANTIATE_TEST_SUITE_P(
    Document, SceneRefusal,
    testing::Values(
        RefusedValue{"UnknownKey", with_sphere(R"("gravty": [0, 0, 0])"),
                     "gravty: unknown key; did you mean \"gravity\"? Known keys: $schema, name, "
                     "gravity, seed"},
        RefusedValue{
            "UnknownNestedKey", with_sphere(R"("solver": {"max_iteration": 3})"),
            "solver.max_iteration: unknown key; did you mean \"max_iterations\"? Known keys: "
            "name, stop"},
        RefusedValue{"Schema", with_sphere(R"("$schema": {})"),
                     "$schema: {} is not allowed: must be a text in quotes"},
        RefusedValue{"Materials",
                     [] {
                       std::string names;
                       for (int i = 0; i < 257; ++i)
                         names += (i == 0 ? "\"" : ", \"") + std::to_string(i) + "\": {}";
                       return with_sphere("\"materials\": {" + names + "}");
                     }(),
                     "materials: 257 materials are not allowed: must be 256 or fewer"},
        RefusedValue{"MissingTimeStep", R"({"duration": 1})",
                     "time_step: missing: must be positive [s]"},
        RefusedValue{"MissingDuration", R"({"time_step": 1})",
                     "duration: missing: must be zero or positive [s]"},
        RefusedValue{"ZeroTimeStep", R"({"time_step": 0, "duration": 1})",
                     "time_step: 0 is not allowed: must be positive [s]"},
        RefusedValue{"TextForNumber", R"({"time_step": "1", "duration": 1})",
                     "time_step: \"1\" is not allowed: must be a number; it must be positive [s]"},
        RefusedValue{"NumberForText", with_sphere(R"("name": 3)"),
                     "name: 3 is not allowed: must be a text in quotes"},
        RefusedValue{"NumberForBoolean", with_sphere(R"("solver": {"warm_start": 1})"),
                     "solver.warm_start: 1 is not allowed: must be true or false"},
        RefusedValue{"NumberForList", R"({"time_step": 1, "duration": 1, "bodies": 3})",
                     "bodies: 3 is not allowed: must be a list [...]"},
        RefusedValue{"ShortVector", with_sphere(R"("gravity": [1, 2])"),
                     "gravity: [1,2] is not allowed: must be three numbers [x, y, z] [m/s^2]"},
        RefusedValue{"TextInVector", with_sphere(R"("gravity": [1, 2, "3"])"),
                     "gravity[2]: \"3\" is not allowed: must be a finite number [m/s^2]"},
        RefusedValue{
            "FractionForInteger", with_sphere(R"("solver": {"max_iterations": 1.5})"),
            "solver.max_iterations: 1.5 is not allowed: must be a whole number, 1 or more"},
        RefusedValue{"NegativeSeed", with_sphere(R"("seed": -1)"),
                     "seed: -1 is not allowed: must be a whole number, 0 or more"},
        RefusedValue{
            "UnknownSolver", with_sphere(R"("solver": {"name": "jacoby"})"),
            "solver.name: \"jacoby\" is not allowed: must be one of \"apgd\", \"jacobi\", "
            "\"gauss_seidel\", \"gauss_seidel_colored\", \"schwarz\"; did you mean \"jacobi\"?"},
        RefusedValue{"UnknownStop", with_sphere(R"("solver": {"stop": "fast"})"),
                     "solver.stop: \"fast\" is not allowed: must be one of \"quality\""},
        RefusedValue{"NegativeStop", with_sphere(R"("solver": {"stop": -1})"),
                     "solver.stop: -1 is not allowed: must be positive [m/s]"},
        RefusedValue{"Relaxation", with_sphere(R"("solver": {"relaxation": 2})"),
                     "solver.relaxation: 2 is not allowed: must be between 0 and 2, both excluded"},
        RefusedValue{"Backend", with_sphere(R"("backend": "gpu")"),
                     "backend: \"gpu\" is not allowed: must be one of \"auto\", \"cpu\", \"cuda\""},
        RefusedValue{"Precision", with_sphere(R"("precision": "half")"),
                     "precision: \"half\" is not allowed: must be one of \"float\", \"double\""},
        RefusedValue{"Envelope", with_sphere(R"("collision": {"envelope": -1})"),
                     "collision.envelope: -1 is not allowed: must be zero or positive [m]"},
        RefusedValue{"Skin", with_sphere(R"("collision": {"skin": -1})"),
                     "collision.skin: -1 is not allowed: must be zero or positive [m]"},
        RefusedValue{
            "PictureWidth", with_sphere(R"("output": {"picture": {"width": 8}})"),
            "output.picture.width: 8 is not allowed: must be a whole number from 16 to 16384"},
        RefusedValue{
            "ColorRange", with_sphere(R"("output": {"picture": {"color_range": [2, 1]}})"),
            "output.picture.color_range: [2,1] is not allowed: must be two numbers [low, high]"},
        RefusedValue{
            "CameraAngle", with_sphere(R"("output": {"picture": {"camera": {"position": [1, 0, 0],
                  "target": [0, 0, 0], "vertical_angle_deg": 170}}})"),
            "output.picture.camera.vertical_angle_deg: 170 is not allowed: must be between 0 "
            "and 170"},
        RefusedValue{
            "CameraUp", with_sphere(R"("output": {"picture": {"camera": {"position": [0, 0, 1],
                  "target": [0, 0, 0]}}})"),
            "output.picture.camera.up: [0, 0, 1] is not allowed: must not be zero or parallel"},
        RefusedValue{"Friction", with_sphere(R"("materials": {"a": {"friction": -0.1}})"),
                     "materials.a.friction: -0.1 is not allowed: must be zero or positive [-]"},
        RefusedValue{"Restitution", with_sphere(R"("materials": {"a": {"restitution": 1.1}})"),
                     "materials.a.restitution: 1.1 is not allowed: must be from 0 to 1 [-]"},
        RefusedValue{"NoMaterial", with_sphere(R"("materials": {})"),
                     "materials: {} is not allowed: must hold one material or more"},
        RefusedValue{
            "PairName",
            with_sphere(
                R"("materials": {"steel": {}}, "material_pairs": [{"between": ["steel", "stel"]}])"),
            "material_pairs[0].between[1]: \"stel\" is not allowed: must be a name of materials: "
            "steel; did you mean \"steel\"?"},
        RefusedValue{
            "PairTwice", with_sphere(R"("materials": {"a": {}, "b": {}}, "material_pairs":
                  [{"between": ["a", "b"]}, {"between": ["b", "a"]}])"),
            "material_pairs[1].between: [\"b\", \"a\"] is not allowed: material_pairs[0] is "
            "the same"},
        RefusedValue{"PeriodTooShort", with_sphere(R"("periodic": {"x": [0, 0.4]})"),
                     "periodic.x: [0, 0.4] is not allowed: must span at least 0.404 m"},
        RefusedValue{
            "HalfSpaceAcrossAPeriod",
            R"({"time_step": 1, "duration": 1, "periodic": {"x": [0, 1]}, "bodies": [
                  {"shape": "sphere", "radius": 0.1, "density": 1},
                  {"shape": "half_space", "normal": [0, 0, 1], "point": [0, 0, 0]},
                  {"shape": "half_space", "normal": [0.6, 0, 0.8], "point": [0, 0, 0]}]})",
            "bodies[2].normal: [0.6, 0, 0.8] is not allowed: must have no component along x: "
            "the domain repeats along x, so no plane can bound x"},
        RefusedValue{"ContainerClosedAcrossAPeriod",
                     R"({"time_step": 1, "duration": 1, "periodic": {"y": [0, 1]}, "bodies": [
                  {"shape": "sphere", "radius": 0.1, "density": 1, "position": [0, 0.5, 0.5]},
                  {"shape": "container", "min": [-1, 0, 0], "max": [1, 1, 1], "open": ["-y"]}]})",
                     "bodies[1].open: a container closed at +y is not allowed: must name \"+y\""},
        RefusedValue{
            "WallOverManyPeriods",
            R"({"time_step": 1, "duration": 1, "periodic": {"x": [0, 1]}, "bodies": [
                  {"shape": "sphere", "radius": 0.1, "density": 1, "position": [0, 0, 1]},
                  {"shape": "box", "kind": "fixed", "size": [5.5, 1, 1]}]})",
            "bodies[1]: a wall of 5.5 m along x is not allowed: must span 5 periods at most"},
        RefusedValue{
            "PeriodReversed", with_sphere(R"("periodic": {"x": [1, 0]})"),
            "periodic.x: [1,0] is not allowed: must be two numbers [low, high], low below high "
            "[m]"},
        RefusedValue{
            "NothingFree",
            R"({"time_step": 1, "duration": 1, "bodies": [{"shape": "half_space"}]})",
            "bodies: a scene of 1 bodies, none free is not allowed: must hold one free body"}),
    [](const auto& one) { return std::string(one.param.what); });

INSTANTIATE_TEST_SUITE_P(
    Body, SceneRefusal,
    testing::Values(
        RefusedValue{"NegativeRadius",
                     with_body(R"({"shape": "sphere", "radius": -0.1, "mass": 1})"),
                     "bodies[1].radius: -0.1 is not allowed: must be positive [m]"},
        RefusedValue{"MissingShape", with_body(R"({"radius": 1})"),
                     "bodies[1].shape: missing: must be one of"},
        RefusedValue{
            "UnknownShape", with_body(R"({"shape": "spere"})"),
            "bodies[1].shape: \"spere\" is not allowed: must be one of \"sphere\", \"box\", "
            "\"half_space\", \"container\", \"mesh\", \"capsule\", \"cylinder\", \"hull\", "
            "\"cone\", \"ellipsoid\", \"compound\", \"height_field\"; did you mean "
            "\"sphere\"?"},
        RefusedValue{"KeyOfOtherShape", with_body(R"({"shape": "box", "radius": 1})"),
                     "bodies[1].radius: a box has no such key"},
        RefusedValue{
            "MissingMass", with_body(R"({"shape": "sphere", "radius": 1})"),
            "bodies[1].density: missing: a free body needs a density [kg/m^3] or a mass [kg]"},
        RefusedValue{"MassAndDensity",
                     with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "density": 1})"),
                     "bodies[1].density: give either mass or density"},
        RefusedValue{
            "Inertia",
            with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "inertia": [1, 0, 1]})"),
            "bodies[1].inertia: [1,0,1] is not allowed: must be three positive principal moments"},
        RefusedValue{
            "FreeHalfSpace", with_body(R"({"shape": "half_space", "kind": "free"})"),
            "bodies[1].kind: \"free\" is not allowed: only sphere, box, capsule, cylinder, "
            "hull, cone, ellipsoid or compound "
            "bodies can be free"},
        RefusedValue{"VelocityOfAWall",
                     with_body(R"({"shape": "half_space", "velocity": [1, 0, 0]})"),
                     "bodies[1].velocity: only free bodies have this key"},
        RefusedValue{"ZeroNormal", with_body(R"({"shape": "half_space", "normal": [0, 0, 0]})"),
                     "bodies[1].normal: [0,0,0] is not allowed: must be a direction"},
        RefusedValue{
            "Quaternion", with_body(R"({"shape": "half_space", "orientation": [1, 1, 0, 0]})"),
            "bodies[1].orientation: [1,1,0,0] is not allowed: must be a unit quaternion [w, x, "
            "y, z]"},
        RefusedValue{"TwoRotations",
                     with_body(R"({"shape": "half_space", "orientation": [1, 0, 0, 0],
                  "rotation_deg": {"axis": [1, 0, 0], "angle": 1}})"),
                     "bodies[1].rotation_deg: give either orientation or rotation_deg"},
        RefusedValue{"BoxSize",
                     with_body(R"({"shape": "box", "kind": "fixed", "size": [1, 0, 1]})"),
                     "bodies[1].size: [1,0,1] is not allowed: must be positive [m]"},
        RefusedValue{"Corners",
                     with_body(R"({"shape": "container", "min": [0, 0, 0], "max": [1, 0, 1]})"),
                     "bodies[1].max: [1,0,1] is not allowed: must be above min on every axis [m]"},
        RefusedValue{
            "CornersAndSize",
            with_body(
                R"({"shape": "container", "min": [0, 0, 0], "max": [1, 1, 1], "size": [1, 1, 1]})"),
            "bodies[1].size: give either min and max, or size and position"},
        RefusedValue{"OpenFace",
                     with_body(R"({"shape": "container", "size": [1, 1, 1], "open": ["top"]})"),
                     "bodies[1].open[0]: \"top\" is not allowed: must be one of \"-x\", \"+x\""},
        RefusedValue{"Lock",
                     with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "lock": ["w"]})"),
                     "bodies[1].lock[0]: \"w\" is not allowed: must be one of \"x\", \"y\""},
        RefusedValue{
            "Material", with_body(R"({"shape": "half_space", "material": "steel"})"),
            "bodies[1].material: \"steel\" is not allowed: must be a name of materials: default"},
        RefusedValue{"MissingMesh", with_body(R"({"shape": "mesh", "file": "none.stl"})"),
                     "bodies[1].file: \"none.stl\" is not allowed: no such file"},
        RefusedValue{"InsertAt",
                     with_body(R"({"shape": "sphere", "radius": 1, "mass": 1, "insert_at": -1})"),
                     "bodies[1].insert_at: -1 is not allowed: must be zero or positive [s]"},
        RefusedValue{"MotionOfAFixedBody",
                     with_body(R"({"shape": "half_space", "motion": {"type": "linear"}})"),
                     "bodies[1].motion: only bodies of kind \"kinematic\" have a motion"},
        RefusedValue{"MissingMotion", with_body(R"({"shape": "half_space", "kind": "kinematic"})"),
                     "bodies[1].motion: missing: a kinematic body needs one"},
        RefusedValue{
            "MotionType",
            with_body(
                R"({"shape": "half_space", "kind": "kinematic", "motion": {"type": "spin"}})"),
            "bodies[1].motion.type: \"spin\" is not allowed: must be one of \"linear\""},
        RefusedValue{"MotionKey", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "linear", "velocity": [0, 0, 0], "rate": 1}})"),
                     "bodies[1].motion.rate: a motion of type \"linear\" has no such key"},
        RefusedValue{"Times", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "sampled", "times": [0, 0], "positions": [[0, 0, 0], [0, 0, 0]]}})"),
                     "bodies[1].motion.times[1]: 0 is not allowed: must be finite and larger"},
        RefusedValue{
            "Positions", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "sampled", "times": [0, 1], "positions": [[0, 0, 0]]}})"),
            "bodies[1].motion.positions: 1 positions is not allowed: must be one per time, 2"},
        RefusedValue{"StopBeforeStart", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "linear", "velocity": [1, 0, 0], "start": 2, "stop": 1}})"),
                     "bodies[1].motion.stop: 1 is not allowed: must not be before start [s]"},
        RefusedValue{"RateOfHalfATurnAStep",
                     with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "rotating", "axis": [0, 0, 1], "rate": -4e3}})"),
                     "bodies[1].motion.rate: -4000 is not allowed: must turn the body by less than "
                     "half a turn in a time step of 0.001 s [rad/s]"},
        RefusedValue{"SpinOfHalfATurnAStep",
                     with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "linear", "velocity": [0, 0, 0], "angular_velocity": [0, 4e3, 0]}})"),
                     "bodies[1].motion.angular_velocity: [0, 4000, 0] is not allowed: must turn"},
        RefusedValue{
            "SamplesOfHalfATurnAStep", with_body(R"({"shape": "half_space", "kind": "kinematic",
                  "motion": {"type": "sampled", "times": [0, 1, 1.0005, 1.001], "positions": [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]],
                             "orientations": [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]]}})"),
            "bodies[1].motion.orientations[1]: 6.283 rad within a time step is not allowed: "
            "must turn the body by less than half a turn in a time step of 0.001 s"},
        RefusedValue{
            "MomentsOfNoBody",
            with_body(R"({"shape": "box", "size": [1, 1, 1], "mass": 1, "position": [0, 0, 5],
                  "inertia": [1, 0.5, 0.4]})"),
            "bodies[1].inertia: [1, 0.5, 0.4] is not allowed: must have no moment larger "
            "than the sum of the other two"},
        RefusedValue{"OverlappingContainers",
                     with_body(R"({"shape": "container", "size": [1, 1, 1]},
                  {"shape": "container", "size": [1, 1, 1], "position": [0.5, 0, 0]})"),
                     "bodies[2]: a container is not allowed: its interior partly overlaps that of "
                     "bodies[1]"}),
    [](const auto& one) { return std::string(one.param.what); });

INSTANTIATE_TEST_SUITE_P(
    Particles, SceneRefusal,
    testing::Values(
        RefusedValue{"Layout", with_particles(R"({"layout": "heap"})"),
                     "particles[0].layout: \"heap\" is not allowed: must be one of \"lattice\""},
        RefusedValue{"MissingDensity", with_particles(R"({"layout": "lattice", "radius": 1})"),
                     "particles[0].density: missing: must be positive [kg/m^3]"},
        RefusedValue{"MissingRegion", with_particles("{" + kLattice + R"("count": 1})"),
                     "particles[0].region: missing: the space to fill"},
        RefusedValue{"ZeroCount", with_particles("{" + kLattice + kUnitBox + R"(, "count": 0})"),
                     "particles[0].count: 0 is not allowed: must be a whole number, 1 or more"},
        RefusedValue{
            "TooMany", with_particles("{" + kLattice + kUnitBox + R"(, "count": 65})"),
            "particles[0].count: 65 is not allowed: the region holds 64 spheres at a spacing of"},
        RefusedValue{
            "Spacing", with_particles("{" + kLattice + kUnitBox + R"(, "spacing": 0.1})"),
            "particles[0].spacing: 0.1 is not allowed: must be at least the largest diameter, "
            "0.2 [m]"},
        RefusedValue{"Jitter", with_particles("{" + kLattice + kUnitBox + R"(, "jitter": 2})"),
                     "particles[0].jitter: 2 is not allowed: must be from 0 to 1 [-]"},
        RefusedValue{"KeyOfOtherLayout",
                     with_particles("{" + kLattice + kUnitBox + R"(, "layers": 2})"),
                     "particles[0].layers: the layout \"lattice\" has no such key"},
        RefusedValue{
            "RandomTooMany",
            with_particles(R"({"layout": "random", "count": 500, "radius": 0.1, "density": 1,)" +
                           kUnitBox + "}"),
            "particles[0].count: 500 is not allowed: "},
        RefusedValue{
            "RandomTooWide",
            with_particles(R"({"layout": "random", "count": 2, "radius": 0.6, "density": 1,)" +
                           kUnitBox + "}"),
            "particles[0].count: 2 is not allowed: 0 of 2 spheres fit: the largest sphere is "
            "wider"},
        RefusedValue{
            "RadiusRange",
            with_particles(
                R"({"layout": "random", "count": 2, "radius": {"min": 2, "max": 1}, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].radius.max: 1 is not allowed: must not be below min [m]"},
        RefusedValue{
            "RadiusKinds",
            with_particles(
                R"({"layout": "random", "count": 2, "radius": {"min": 1, "values": [1]}, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].radius: {\"min\":1,\"values\":[1]} is not allowed: must have exactly one "
            "of"},
        RefusedValue{
            "Weights",
            with_particles(
                R"({"layout": "random", "count": 2, "radius": {"values": [1, 2], "weights": [1]}, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].radius.weights: [1] is not allowed: must be one weight per value"},
        RefusedValue{
            "Normal",
            with_particles(R"({"layout": "random", "count": 2, "radius": {"normal":
                  {"mean": 5, "deviation": 0.1, "min": 1, "max": 2}}, "density": 1,)" +
                           kUnitBox + "}"),
            "particles[0].radius.normal.mean: 5 is not allowed: must be from min to max [m]"},
        RefusedValue{
            "RegionReversed",
            with_particles("{" + kLattice + R"("region": {"min": [0, 0, 1], "max": [1, 1, 0]}})"),
            "particles[0].region.max: [1,1,0] is not allowed: must be above min on every axis [m]"},
        RefusedValue{
            "RainTooFast",
            with_particles(
                R"({"layout": "rain", "count": 20, "layers": 2, "interval": 0.01, "radius": 0.1, "density": 1,)" +
                kUnitBox + "}"),
            "particles[0].interval: 0.01 is not allowed: a batch of height"},
        RefusedValue{"MissingFile", with_particles(R"({"layout": "file", "file": "none.csv"})"),
                     "particles[0].file: \"none.csv\" is not allowed: no such file"}),
    [](const auto& one) { return std::string(one.param.what); });

TEST(SceneReader, RefusesBadOverrides) {
  const std::string text = with_sphere("");
  EXPECT_EQ(refused_text(text, {"seed"}), "override \"seed\": must have the form key.path=value");
  EXPECT_EQ(
      refused_text(text, {"bodies.1.radius=1"}),
      "override \"bodies.1.radius=1\": bodies has 1 elements; \"1\" must be a number from 0 to 0");
  EXPECT_EQ(refused_text(text, {"duration.x=1"}),
            "override \"duration.x=1\": duration is the value 1, it has no key \"x\"");
  EXPECT_EQ(refused_text(text, {"time_step=-1"}),
            "x.json: time_step (overridden): -1 is not allowed: must be positive [s]");
  // Found after reading.
  EXPECT_THAT(refused_text(text, {"time_step=1e-320"}),
              StartsWith("x.json: time_step (overridden): "));
  EXPECT_THAT(refused_text(text, {"gravity=[0,0,1e300]"}),
              StartsWith("x.json: gravity (overridden): "));
  EXPECT_THAT(refused_text(text, {"tim_step=1"}),
              StartsWith("x.json: tim_step (overridden): unknown key"));
}

TEST(SceneReader, RefusesMissingFiles) {
  const std::string path = testing::TempDir() + "no_such_scene.json";
  EXPECT_EQ(refusal([&] { read_scene(path); }), path + ": no such file");
}

TEST(SceneReader, GuessesNoNameThatHasNothingInCommon) {
  EXPECT_THAT(refused_text(with_sphere(R"("solver": {"name": "q"})")),
              testing::EndsWith("\"gauss_seidel_colored\", \"schwarz\""));
}

TEST(SceneReader, NamesTheFileOfABadMeshAndABadTable) {
  const auto mesh = write_file("bad.obj", "v 0 0 0\nf 1 2 3\n");
  const auto table = write_file("bad.csv", "x,y,z\n1,2,oops\n");
  const auto first = write_file("a.json", with_body(R"({"shape": "mesh", "file": "bad.obj"})"));
  const auto second = write_file(
      "b.json",
      with_particles(R"({"layout": "file", "file": "bad.csv", "radius": 1, "density": 1})"));
  EXPECT_THAT(
      refusal([&] { read_scene(first); }),
      StartsWith(first.string() + ": bodies[1].file: " + mesh.string() + ": line 2: vertex 2"));
  EXPECT_EQ(refusal([&] { read_scene(second); }),
            second.string() + ": particles[0].file: " + table.string() +
                ": line 2, column \"z\": \"oops\" is not allowed: must be a finite number");
}

}  // namespace
}  // namespace scree
