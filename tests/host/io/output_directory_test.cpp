#include "host/io/output_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <optional>

#include "host/error.h"
#include "host/io/checkpoint.h"
#include "tests/host/io/output_fixtures.h"

namespace scree {
namespace {

namespace fs = std::filesystem;
using test::put;
using test::ScratchDirectory;
using testing::AllOf;
using testing::HasSubstr;

const std::string scene_text =
    R"({"name": "bed", "stepping": {"time_step": 0.001, "duration": 2}})";

class OutputDirectoryTest : public testing::Test {
 protected:
  std::string refusal(const fs::path& path, ExistingOutput existing,
                      const std::string& text = scene_text,
                      const std::vector<std::string>& may_differ = {}) {
    try {
      OutputDirectory output(path, existing, text, may_differ);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path.string()));
      return error.what();
    }
    return {};
  }
  void write_run(const fs::path& path) {
    fs::create_directories(path);
    put(path / "run.json", "{}");
    put(path / "steps.csv", "step\n");
    put(path / "frames.vtkhdf", "frames");
    put(path / "picture_00001.png", "picture");
    write_checkpoint(path / "checkpoint.h5", test::empty_state(), BodyConstants(Scene{}),
                     scene_text, BackendKind::cpu, Precision::single_precision);
  }
  ScratchDirectory scratch;
  fs::path out = scratch / "out";
};

TEST_F(OutputDirectoryTest, IsCreatedWithItsParentsButNotBeforePrepare) {
  const fs::path deep = out / "a" / "b";
  OutputDirectory output(deep, ExistingOutput::refuse, scene_text);
  EXPECT_FALSE(fs::exists(out));
  output.prepare();
  EXPECT_TRUE(fs::is_directory(deep));
  EXPECT_EQ(output.picture(42), deep / "picture_00042.png");
  EXPECT_FALSE(output.resuming());
  EXPECT_FALSE(output.take_checkpoint().has_value());
}

TEST_F(OutputDirectoryTest, AcceptsRelativeNamesAndTrailingSlashes) {
  const fs::path before = fs::current_path();
  fs::current_path(scratch.path());
  for (const char* name : {"x", "y/", "./z/../w/"}) {
    OutputDirectory output(name, ExistingOutput::refuse, scene_text);
    output.prepare();
    EXPECT_TRUE(fs::is_directory(name)) << name;
  }
  fs::current_path(before);
}

TEST_F(OutputDirectoryTest, AnEmptyDirectoryIsFine) {
  fs::create_directory(out);
  EXPECT_EQ(refusal(out, ExistingOutput::refuse), "");
}

TEST_F(OutputDirectoryTest, RefusesADirectoryThatIsNotEmpty) {
  write_run(out);
  EXPECT_THAT(refusal(out, ExistingOutput::refuse),
              AllOf(HasSubstr("not empty"), HasSubstr("--force"), HasSubstr("--resume")));
  EXPECT_TRUE(fs::exists(out / "run.json"));
}

TEST_F(OutputDirectoryTest, ForceRemovesOnlyWhatRunsWrite) {
  write_run(out);
  const std::vector<std::string> foreign{
      "notes.txt", "picture_1.jpg",     "picture_x.png", "frames.vtk",
      ".run.json", "checkpoint.h5.bak", "picture_.png",  "sub"};
  for (const std::string& name : foreign)
    if (name != "sub") put(out / name, name);
  fs::create_directory(out / "sub");
  put(out / "sub" / "run.json", "deep");
  put(out / "frames.vtkhdf.next", "left by a kill");
  put(out / "frames.vtkhdf.next.tmp", "left by a kill");
  put(out / "run.json.tmp", "left by a kill");
  {
    OutputDirectory output(out, ExistingOutput::replace, scene_text);
    EXPECT_TRUE(
        fs::exists(out / "run.json"));  // nothing is removed before the run is known to start
    output.prepare();
  }
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(out)) left.push_back(entry.path().filename());
  EXPECT_THAT(left, testing::UnorderedElementsAreArray(foreign));
  EXPECT_EQ(test::contents(out / "sub" / "run.json"), "deep");
}

TEST_F(OutputDirectoryTest, RefusesADirectoryInTheWayOfAFile) {
  fs::create_directories(out / "steps.csv");
  EXPECT_THAT(refusal(out, ExistingOutput::replace), HasSubstr("steps.csv is a directory"));
}

TEST_F(OutputDirectoryTest, RefusesWhatIsNoDirectory) {
  put(out, "file");
  EXPECT_THAT(refusal(out, ExistingOutput::refuse), HasSubstr("not a directory"));
  EXPECT_THAT(refusal(out, ExistingOutput::replace), HasSubstr("not a directory"));
  EXPECT_THAT(refusal(out / "below", ExistingOutput::refuse), HasSubstr("ot a directory"));
  fs::create_symlink(scratch / "nowhere", scratch / "link");
  EXPECT_THAT(refusal(scratch / "link", ExistingOutput::refuse), HasSubstr("link to nowhere"));
  EXPECT_THROW(OutputDirectory("", ExistingOutput::refuse, scene_text), InputError);
}

TEST_F(OutputDirectoryTest, RefusesWhatCannotBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::create_directory(out);
  fs::permissions(out, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THAT(refusal(out, ExistingOutput::refuse), HasSubstr("Permission denied"));
  EXPECT_THAT(refusal(out / "below", ExistingOutput::refuse), HasSubstr("Permission denied"));
  fs::permissions(out, fs::perms::owner_all);
}

TEST_F(OutputDirectoryTest, RefusesASecondRunInTheSameDirectory) {
  OutputDirectory first(out, ExistingOutput::refuse, scene_text);
  first.prepare();
  EXPECT_THAT(refusal(out, ExistingOutput::refuse), HasSubstr("another run"));
  EXPECT_THAT(refusal(out, ExistingOutput::replace), HasSubstr("another run"));
}

TEST_F(OutputDirectoryTest, ResumeGivesTheCheckpoint) {
  write_run(out);
  OutputDirectory output(out, ExistingOutput::resume, scene_text);
  output.prepare();
  EXPECT_TRUE(output.resuming());
  const std::optional<Checkpoint> checkpoint = output.take_checkpoint();
  ASSERT_TRUE(checkpoint.has_value());
  EXPECT_EQ(checkpoint->scene_text, scene_text);
  EXPECT_TRUE(fs::exists(out / "steps.csv"));
}

TEST_F(OutputDirectoryTest, ResumeSaysWhatIsMissing) {
  EXPECT_THAT(refusal(out, ExistingOutput::resume), HasSubstr("does not exist"));
  fs::create_directory(out);
  EXPECT_THAT(refusal(out, ExistingOutput::resume), HasSubstr("no checkpoint.h5"));
  put(out / "checkpoint.h5", "damaged");
  EXPECT_THAT(refusal(out, ExistingOutput::resume), HasSubstr("cannot read checkpoint"));
}

TEST_F(OutputDirectoryTest, ResumeRefusesAnotherSceneAndNamesTheDifference) {
  write_run(out);
  EXPECT_EQ(refusal(out, ExistingOutput::resume,
                    R"({"stepping":{"duration":2,"time_step":1e-3}, "name":"bed"})"),
            "");
  const std::string other = R"({"name": "bed", "stepping": {"time_step": 0.002, "duration": 3}})";
  EXPECT_THAT(refusal(out, ExistingOutput::resume, other, {"/stepping/duration"}),
              HasSubstr("/stepping/time_step was 0.001 and is now 0.002"));
  EXPECT_EQ(refusal(out, ExistingOutput::resume, other, {"/stepping"}), "");
  EXPECT_THAT(refusal(out, ExistingOutput::resume, R"({"stepping": {}, "name": "bed"})"),
              HasSubstr("/stepping/duration was 2 and is now nothing"));
  EXPECT_THAT(refusal(out, ExistingOutput::resume, "not JSON"), HasSubstr("another scene"));
}

}  // namespace
}  // namespace scree
