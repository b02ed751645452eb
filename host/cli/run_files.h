#pragma once
// What `scree run` writes step by step, but for steps.csv.

#include <cstdint>
#include <optional>

#include "host/io/contact_frames.h"
#include "host/io/forces_csv.h"
#include "host/io/frame_index.h"
#include "host/io/frame_piece.h"
#include "host/io/frames.h"
#include "host/io/output_directory.h"
#include "host/io/surface_frames.h"
#include "host/io/wall_frames.h"

namespace scree {

/// Files that grow during a run.
struct RunFiles {
  /// @param rank_count  that write frames in pieces
  /// @param resumed_step, resumed_time  of the checkpoint that the run goes on from
  RunFiles(const OutputDirectory& directory, const Scene& scene, Precision precision,
           int rank_count, std::optional<std::int64_t> resumed_step,
           std::optional<double> resumed_time)
      : wall_frames(directory.wall_frames(), scene, resumed_time) {
    if (scene.output.frame_pieces) {
      frame_index.emplace(directory.frames(), scene, precision, rank_count, resumed_time);
      if (frame_index->frame_count() > 0) pieces_resumed_time = resumed_time;
      frame_piece.emplace(frame_piece_file(directory.frames(), 0), scene, precision,
                          wall_frames.body_end());
    } else {
      frames.emplace(directory.frames(), scene, precision, resumed_time);
    }
    if (scene.output.contact_frames)
      contact_frames.emplace(directory.contact_frames(), scene.stepping.time_step, precision,
                             resumed_time);
    if (scene.output.surface_frames)
      surface_frames.emplace(directory.surface_frames(), scene, resumed_time);
    if (scene.output.force_interval > 0)
      forces.emplace(directory.forces_csv(), ForceTargets(scene), resumed_step);
    for_each_frame_file([](auto& file) { file.publish_seldom(); });
  }

  /// Frames that wait are published. @throws RunError
  void publish() {
    for_each_frame_file([](auto& file) { file.publish(); });
    if (frame_index) frame_index->publish();
  }

  WallFrameWriter wall_frames;
  std::optional<FrameWriter> frames;      ///< else in pieces
  std::optional<FrameIndex> frame_index;  ///< of the pieces
  std::optional<FramePiece> frame_piece;  ///< of rank 0
  std::optional<double> pieces_resumed_time;
  std::optional<ContactFrameWriter> contact_frames;
  std::optional<SurfaceFrameWriter> surface_frames;
  std::optional<ForcesCsv> forces;

 private:
  /// Pieces are not among them: their index tells of frames that are on disk.
  template <class Visit>
  void for_each_frame_file(const Visit& visit) {
    visit(wall_frames);
    if (frames) visit(*frames);
    if (contact_frames) visit(*contact_frames);
    if (surface_frames) visit(*surface_frames);
  }
};

}  // namespace scree
