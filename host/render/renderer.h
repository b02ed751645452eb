#pragma once
// Pictures of the bodies, made in backend memory; only the finished pixels come to the host.

#include "host/render/camera.h"
#include "host/render/labels.h"
#include "host/scene.h"
#include "host/world.h"
#include "kernels/backend/backend.h"
#include "kernels/bodies/body_view.h"
#include "kernels/render/shade.h"
#include "kernels/render/statistics.h"

namespace scree {

/// Draws bodies. A picture is drawn and shaded in bands of rows, so that only a window of its
/// samples (four a pixel) is in memory.
///
/// Keeps its buffers from picture to picture. They take 24 bytes a body, 9 bytes a sample of the
/// window (kSampleBudget samples, or 432 rows where those are more), and 4 bytes a sample of the
/// light's view (a square of 1.5 times the larger side of the picture, at most 8192): 25 MB for a
/// picture of 1280x960, 48 MB for 1920x1080.
///
/// The same bodies give the same bytes for any number of threads and bands, and on every run.
template <class B, class Real>
class Renderer {
 public:
  static constexpr Offset kSampleBudget = 1'100'000;  ///< default of sample_budget

  /// @param sample_budget  samples of the picture to hold at once; a band has at least
  ///                       kLeastBandRows rows, whatever this says
  explicit Renderer(B& backend, Offset sample_budget = kSampleBudget);

  /// @param bodies    all in backend memory, as are `shapes` and `meshes`
  /// @param shapes    records that BodyView::shape points to
  /// @param settings  picture size, colors and camera
  /// @param range     out, when given: the values at the ends of the color map
  /// @throws InputError when the scene has more triangles than 32-bit numbers can count
  /// @throws OutOfMemory
  Image render(B& backend, const BodyView<Real>& bodies, Span<const ShapeRecord<Real>> shapes,
               const MeshSetView<Real>& meshes, const PictureSettings& settings,
               render::ColorRange* range = nullptr);

 private:
  /// Where the bodies are and how large they are.
  struct Extent {
    render::KeepRule keep;   ///< leaves escaped bodies out
    render::Box free;        ///< free bodies, escaped ones left out
    render::Box walls;       ///< fixed bodies, as far as they are near the free ones
    render::Box framed;      ///< both: what an automatic camera shows
    double mean_radius = 0;  ///< of the free bodies [m]
  };

  using Shapes = Span<const ShapeRecord<Real>>;

  render::BodyStatistics measure(B&, const BodyView<Real>&, Shapes, Index first, Index count,
                                 const render::KeepRule& keep);
  render::Box bulk(B&, const BodyView<Real>&);
  Extent find_extent(B&, const BodyView<Real>&, Shapes);
  CameraSettings automatic_camera(B&, const BodyView<Real>&, const Extent&, const PictureSettings&);
  render::DrawList<Real> make_draw_list(B&, const BodyView<Real>&, Shapes, const MeshSetView<Real>&,
                                        const Vec3d& eye, const Vec3d& focus);
  render::ColorRange color_range(B&, const render::ColorValue<Real>&, Index owned_count,
                                 const PictureSettings&, double mean_radius);
  /// Fills the drawn rows of a view's buffer.
  template <class Sample>
  void clear(B&, const render::View&, Span<Sample> samples, Sample value);
  /// Draws every primitive of the source into the drawn rows of its buffer.
  template <class Source>
  void draw(B&, const Source&);

  /// Rows of a band [samples], at least: each band goes through all primitives again.
  static constexpr int kLeastBandRows = 112;

  Offset sample_budget_;
  Buffer<B, std::uint64_t> samples_;        ///< visibility, a window of rows
  Buffer<B, std::uint8_t> edges_;           ///< marks, the same window
  Buffer<B, std::uint32_t> light_samples_;  ///< depth
  Buffer<B, Index> counts_;
  Buffer<B, Offset> begins_;
  Buffer<B, Offset> triangle_begin_;
  Buffer<B, render::Vec3f> color_;
  Buffer<B, std::uint8_t> rgb_;
  Buffer<B, Vec3d> picked_;
  Buffer<B, render::BodyStatistics> body_statistics_;
  Buffer<B, render::FrameSides> frame_sides_;
  Buffer<B, render::ValueStatistics> value_statistics_;
};

}  // namespace scree
