#include "host/io/frame_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "host/error.h"
#include "host/io/frame_piece.h"
#include "host/io/frame_reader.h"
#include "host/io/values.h"
#include "tests/frame_bytes.h"
#include "tests/host/io/output_fixtures.h"

namespace scree {
namespace {

namespace fs = std::filesystem;
using test::expect_same_frames;
using test::frame_bytes;
using test::scene_with;
using test::ScratchDirectory;
using test::states_of;
using testing::HasSubstr;

/// Bodies of a frame that a rank owns: they go around.
OwnBodies owned(int rank, int ranks, int frame, int bodies) {
  const BodyStates all = states_of(frame, bodies);
  OwnBodies own;
  for (int id = 0; id < bodies; ++id) {
    if ((id + frame) / 2 % ranks != rank) continue;
    const auto i = static_cast<std::size_t>(id);
    own.id.push_back(id);
    own.states.position.push_back(all.position[i]);
    own.states.orientation.push_back(all.orientation[i]);
    own.states.velocity.push_back(all.velocity[i]);
    own.states.angular_velocity.push_back(all.angular_velocity[i]);
  }
  return own;
}

class FrameIndexTest : public testing::Test {
 protected:
  /// What ranks write of frames `first` to `end` - 1, as a run does; frame k is at k / 2 s.
  /// @param publishes  the end of a run
  void write(int ranks, int first, int end, std::optional<double> resume = {},
             bool publishes = true) {
    FrameIndex index(file, scene, Precision::single_precision, ranks, resume);
    const auto pieces_resume = index.frame_count() > 0 ? resume : std::nullopt;
    std::vector<std::unique_ptr<FramePiece>> pieces;
    for (int rank = 0; rank < ranks; ++rank) {
      pieces.push_back(std::make_unique<FramePiece>(frame_piece_file(file, rank), scene,
                                                    Precision::single_precision));
      pieces.back()->begin(constants, pieces_resume);
    }
    for (int frame = first; frame < end; ++frame) {
      std::vector<std::int64_t> counts;
      for (int rank = 0; rank < ranks; ++rank) {
        const OwnBodies own = owned(rank, ranks, frame, bodies_in(frame));
        pieces[static_cast<std::size_t>(rank)]->take(frame * 0.5, own, constants);
        counts.push_back(std::ssize(own.id));
      }
      index.append(frame * 0.5, counts);
    }
    if (publishes) index.publish();
  }
  /// The same bodies in one file.
  fs::path whole(int first, int end) {
    fs::path path = directory / "whole.vtkhdf";
    FrameWriter writer(path, scene, Precision::single_precision);
    for (int frame = first; frame < end; ++frame)
      writer.append(frame * 0.5, states_of(frame, bodies_in(frame)));
    return path;
  }
  int bodies_in(int frame) const { return grows ? std::min(3 + 2 * frame, 17) : 17; }
  std::string refusal(int ranks, double resume) {
    try {
      FrameIndex(file, scene, Precision::single_precision, ranks, resume);
    } catch (const InputError& error) {
      return error.what();
    }
    return "it was not refused";
  }
  bool has_piece(int rank) const { return fs::exists(frame_piece_file(file, rank)); }

  ScratchDirectory directory;
  fs::path file = directory / "frames.vtkhdf";
  Scene scene = scene_with(17, 0, 0);
  BodyConstants constants{scene};
  bool grows = false;
};

TEST_F(FrameIndexTest, PiecesReadAsOneFile) {
  for (const int ranks : {1, 2, 3}) {
    SCOPED_TRACE(ranks);
    write(ranks, 0, 9);
    expect_same_frames(file, whole(0, 9));
  }
}

TEST_F(FrameIndexTest, APieceOpensAlone) {
  write(3, 0, 5);
  for (int rank = 0; rank < 3; ++rank) {
    const auto frames = frame_bytes(frame_piece_file(file, rank));
    ASSERT_EQ(frames.size(), 5u);
    for (int frame = 0; frame < 5; ++frame) {
      const OwnBodies own = owned(rank, 3, frame, 17);
      EXPECT_THAT(frames[static_cast<std::size_t>(frame)].ids(), testing::ElementsAreArray(own.id));
    }
  }
}

TEST_F(FrameIndexTest, BodiesComeAndRanksMayHaveNone) {
  grows = true;
  write(4, 0, 9);  // the first frames have bodies of two ranks only
  const FramePieces pieces = read_frame_pieces(h5::File::open(file).root());
  EXPECT_LT(pieces.of_frame(0).size(), 4u);
  EXPECT_EQ(pieces.of_frame(8).size(), 4u);
  expect_same_frames(file, whole(0, 9));
}

TEST_F(FrameIndexTest, TheReaderGivesBodiesById) {
  write(3, 0, 4);
  const FrameReader pieces(file), one(whole(0, 4));
  ASSERT_EQ(pieces.times(), one.times());
  ASSERT_EQ(pieces.body_count(), one.body_count());
  for (std::size_t frame = 0; frame < 4; ++frame) {
    const BodyStates a = pieces.states(frame), b = one.states(frame);
    EXPECT_EQ(a.position, b.position);
    EXPECT_TRUE(std::ranges::equal(values(a.orientation), values(b.orientation)));
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.angular_velocity, b.angular_velocity);
  }
}

TEST_F(FrameIndexTest, TheReaderNamesWhatIsWrong) {
  const auto refused = [&] {
    try {
      FrameReader reader(file);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("it was not refused");
  };
  write(2, 0, 4);
  fs::copy_file(frame_piece_file(file, 1), directory / "kept");
  fs::remove(frame_piece_file(file, 1));
  EXPECT_EQ(refused(),
            file.string() + ": its piece " + frame_piece_file(file, 1).string() + " is missing");
  fs::copy_file(frame_piece_file(file, 0), frame_piece_file(file, 1));
  EXPECT_THAT(refused(), HasSubstr("has body"));
  write(2, 0, 2);
  fs::rename(file, directory / "short");
  write(2, 0, 4);
  fs::rename(directory / "short", file);  // pieces may be ahead of their index
  EXPECT_EQ(FrameReader(file).times().size(), 2u);
  write(2, 0, 4);
  fs::copy_file(file, directory / "long");
  write(2, 0, 2);
  fs::rename(directory / "long", file);
  EXPECT_THAT(refused(), HasSubstr("rows of bodies, expected"));
}

TEST_F(FrameIndexTest, AnyNumberOfRanksContinues) {
  grows = true;
  write(3, 0, 9);
  write(2, 5, 8, 2.0);  // frames after 2 s are dropped
  expect_same_frames(file, whole(0, 8));
  ASSERT_TRUE(has_piece(2));  // what is left of its frames
  EXPECT_EQ(frame_bytes(frame_piece_file(file, 2)).back().time, 2.0);
  write(5, 7, 9, 3.0);
  expect_same_frames(file, whole(0, 9));
  write(1, 8, 12, 3.5);
  expect_same_frames(file, whole(0, 12));
  write(3, 10, 14, 4.5);
  expect_same_frames(file, whole(0, 14));
}

TEST_F(FrameIndexTest, ARunThatEndsAtOnceLeavesWhatTheNextContinues) {
  write(4, 0, 9);
  write(2, 0, 0, 1.0);  // frames up to 1 s
  expect_same_frames(file, whole(0, 3));
  write(4, 4, 6, 2.0);  // frames that were dropped do not come back
  const std::vector<test::FrameBytes> frames = frame_bytes(file);
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_EQ(frames[2].time, 1.0);
  EXPECT_EQ(frames[3].time, 2.0);
  EXPECT_TRUE(frame_bytes(whole(4, 6))[0] == frames[3]);
}

TEST_F(FrameIndexTest, WithoutFramesToContinueAllBeginsAnew) {
  write(3, 1, 5);
  write(2, 1, 4, 0.0);
  expect_same_frames(file, whole(1, 4));
  EXPECT_FALSE(has_piece(2));
  fs::remove(file);
  write(1, 1, 3, 1.0);
  expect_same_frames(file, whole(1, 3));
  EXPECT_FALSE(has_piece(1));
}

TEST_F(FrameIndexTest, TheIndexIsNeverAheadOfPieces) {
  write(2, 0, 9, {}, /*publishes=*/false);  // as a run that is killed
  const std::size_t shown = frame_bytes(file).size();
  EXPECT_GE(shown, 1u);
  const fs::path all = whole(0, static_cast<int>(shown));
  expect_same_frames(file, all);
}

TEST_F(FrameIndexTest, WhatDoesNotFitIsRefused) {
  write(2, 0, 4);
  fs::rename(frame_piece_file(file, 1), directory / "kept");
  EXPECT_EQ(refusal(2, 1.0), "cannot continue " + file.string() + ": its piece " +
                                 frame_piece_file(file, 1).string() + " is missing");
  fs::rename(directory / "kept", frame_piece_file(file, 1));
  fs::copy_file(file, directory / "kept");
  write(2, 0, 6);
  fs::rename(directory / "kept", file);  // an index of other pieces
  EXPECT_THAT(refusal(2, 9.0), HasSubstr("has 6 frames up to 9 s, expected 4"));
  const std::string before = test::contents(file);
  try {
    FrameWriter writer(file, scene, Precision::single_precision, 1.0);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("in pieces (output.frame_pieces true)"));
  }
  EXPECT_EQ(test::contents(file), before);
  EXPECT_THROW(FrameIndex(file, scene, Precision::double_precision, 2, 1.0), InputError);
  fs::rename(whole(0, 4), file);
  EXPECT_THAT(refusal(2, 1.0), HasSubstr("as one file (output.frame_pieces false)"));
}

TEST(FramePieceName, IsRecognized) {
  EXPECT_EQ(frame_piece_file("out/frames.vtkhdf", 12), "out/frames_12.vtkhdf");
  EXPECT_EQ(rank_of_frame_piece("frames_12.vtkhdf"), 12);
  for (const char* other : {"frames.vtkhdf", "frames_.vtkhdf", "frames_01.vtkhdf",
                            "frames_1.vtkhdf.next", "frames_-1.vtkhdf", "frames_1x.vtkhdf"})
    EXPECT_EQ(rank_of_frame_piece(other), std::nullopt) << other;
}

}  // namespace
}  // namespace scree
