#pragma once
// Member functions of Renderer; included where it is instantiated, after the backend.

#include "host/error.h"
#include "host/render/renderer.h"

namespace scree {

template <class B, class Real>
Renderer<B, Real>::Renderer(B& b, Offset sample_budget)
    : sample_budget_(sample_budget),
      samples_(b),
      edges_(b),
      light_samples_(b),
      counts_(b),
      begins_(b),
      triangle_begin_(b),
      color_(b),
      rgb_(b),
      picked_(b),
      body_statistics_(b),
      frame_sides_(b),
      value_statistics_(b) {}

template <class B, class Real>
render::BodyStatistics Renderer<B, Real>::measure(B& b, const BodyView<Real>& bodies, Shapes shapes,
                                                  Index first, Index count,
                                                  const render::KeepRule& keep) {
  const render::MeasureBodies<Real> program{
      first, bodies.position, bodies.radius, keep, bodies.orientation, bodies.shape, shapes};
  body_statistics_.reserve_discard(1);
  reduce<render::BodyStatistics>(b, count, program,
                                 StoreResult<render::BodyStatistics>{body_statistics_.data()});
  return fetch(b, body_statistics_.data());
}

/// Where most free bodies are, by every n-th of them.
template <class B, class Real>
render::Box Renderer<B, Real>::bulk(B& b, const BodyView<Real>& bodies) {
  constexpr Index kMaxPicked = 1 << 16;
  const Index stride = bodies.owned_count / kMaxPicked + 1;
  const Index count = (bodies.owned_count + stride - 1) / stride;
  picked_.reserve_discard(count);
  for_each(b, count, render::PickPositions{bodies.position, stride, picked_.view(count)});
  return render::bulk_of(download(b, picked_.view(count)));
}

template <class B, class Real>
typename Renderer<B, Real>::Extent Renderer<B, Real>::find_extent(B& b,
                                                                  const BodyView<Real>& bodies,
                                                                  Shapes shapes) {
  const auto box_of = [](const render::BodyStatistics& s) {
    if (s.count == 0) return render::Box{};
    return render::Box{{s.lower[0], s.lower[1], s.lower[2]}, {s.upper[0], s.upper[1], s.upper[2]}};
  };
  Extent extent;
  const render::Box fixed =
      box_of(measure(b, bodies, shapes, bodies.fixed_begin, bodies.fixed_count(), extent.keep));
  auto s = measure(b, bodies, shapes, 0, bodies.owned_count, extent.keep);
  if (s.count == 0) {
    extent.walls = extent.framed = fixed;
    return extent;
  }
  // A few stray bodies must not shrink all others to a dot.
  extent.keep = render::keep_rule(bulk(b, bodies), s.sum_radius / s.count);
  s = measure(b, bodies, shapes, 0, bodies.owned_count, extent.keep);
  extent.mean_radius = s.sum_radius / s.count;
  extent.free = box_of(s);
  const Vec3d size = extent.free.upper - extent.free.lower;
  const double margin = 0.15 * std::max({size.x, size.y, size.z});
  extent.walls = render::cut(fixed, render::grown(extent.free, margin));
  extent.framed = render::join(extent.free, extent.walls);
  return extent;
}

template <class B, class Real>
CameraSettings Renderer<B, Real>::automatic_camera(B& b, const BodyView<Real>& bodies,
                                                   const Extent& extent,
                                                   const PictureSettings& settings) {
  if (extent.framed.empty()) return settings.camera;
  const double aspect = static_cast<double>(settings.width) / settings.height;
  render::FrameAxes axes = render::automatic_axes(settings.camera, extent.framed.center(), aspect);
  frame_sides_.reserve_discard(1);
  for (int pass = 1;; ++pass) {
    const render::MeasureFrame<Real> program{axes, bodies.position, bodies.radius, extent.keep};
    reduce<render::FrameSides>(b, bodies.owned_count, program,
                               StoreResult<render::FrameSides>{frame_sides_.data()});
    render::FrameSides sides = fetch(b, frame_sides_.data());
    sides.combine(render::box_sides(axes, extent.walls));
    if (pass == render::kFramingPasses) {
      return render::framing_camera(settings.camera, axes, sides, extent.framed.diagonal());
    }
    axes = render::narrowed(axes, sides);
  }
}

template <class B, class Real>
render::DrawList<Real> Renderer<B, Real>::make_draw_list(B& b, const BodyView<Real>& bodies,
                                                         Shapes shapes,
                                                         const MeshSetView<Real>& meshes,
                                                         const Vec3d& eye, const Vec3d& focus) {
  render::DrawList<Real> list;
  list.bodies = bodies.without_ghosts();
  list.position = bodies.position;
  list.orientation = bodies.orientation;
  list.radius = bodies.radius;
  list.shape = bodies.shape;
  list.shapes = shapes;
  list.meshes = meshes;
  list.eye = eye;
  list.focus = focus;
  if (meshes.ranges.empty() || shapes.empty()) return list;

  counts_.reserve_discard(shapes.size);
  triangle_begin_.reserve_discard(shapes.size + 1);
  const auto shape_count = static_cast<Index>(shapes.size);
  for_each(b, shape_count, render::CountTriangles<Real>{list, counts_.view(shape_count)});
  exclusive_scan(b, Span<const Index>(counts_.view(shape_count)),
                 triangle_begin_.view(shape_count + 1));
  const Offset triangles = fetch(b, triangle_begin_.data() + shape_count);
  if (triangles + list.body_count() > Offset{0x7fffffff}) {
    throw InputError("picture: more than 2147483647 triangles and bodies");
  }
  list.triangle_begin = triangle_begin_.view(shape_count + 1);
  list.triangle_count = static_cast<Index>(triangles);
  return list;
}

template <class B, class Real>
render::ColorRange Renderer<B, Real>::color_range(B& b, const render::ColorValue<Real>& value,
                                                  Index owned_count,
                                                  const PictureSettings& settings,
                                                  double mean_radius) {
  render::ColorRange range{settings.color_min, settings.color_max};
  const bool by_value = settings.color_by == ColorBy::speed || settings.color_by == ColorBy::size;
  if (by_value && range.low == range.high) {
    value_statistics_.reserve_discard(1);
    reduce<render::ValueStatistics>(b, owned_count, render::MeasureValues<Real>{value},
                                    StoreResult<render::ValueStatistics>{value_statistics_.data()});
    const auto s = fetch(b, value_statistics_.data());
    const double mean = s.count > 0 ? s.sum / s.count : 0;
    const double variance = s.count > 0 ? s.sum_squares / s.count - mean * mean : 0;
    const double deviation = std::sqrt(std::max(variance, 0.0));
    if (settings.color_by == ColorBy::speed) {
      // From rest to nearly the fastest; single fast bodies may go past the end. Below a twentieth
      // of a diameter per second everything is at rest, and noise is not shown as motion.
      range = {0, std::max(std::min(s.high, mean + 3 * deviation), 0.1 * mean_radius)};
    } else {
      range = {s.low, s.high};
      if (!(s.high - s.low > 1e-3 * s.high))
        range = {0.4 * s.high, 1.9 * s.high};  // one size: a middle color
    }
  }
  if (!(range.high > range.low) || !std::isfinite(range.high - range.low))
    range.high = range.low + 1;
  return range;
}

template <class B, class Real>
template <class Sample>
void Renderer<B, Real>::clear(B& b, const render::View& view, Span<Sample> samples, Sample value) {
  for (int j = view.row_begin; j < view.row_end;) {  // in two parts where the rows pass the end
    const int end = std::min(view.row_end, (j / view.buffer_rows + 1) * view.buffer_rows);
    fill(b, Span<Sample>{samples.data + view.index(0, j), Offset{end - j} * view.width}, value);
    j = end;
  }
}

template <class B, class Real>
template <class Source>
void Renderer<B, Real>::draw(B& b, const Source& source) {
  const Index primitive_count = source.primitive_count();
  if (primitive_count == 0 || render::drawn_rect(source.view).empty()) return;
  counts_.reserve_discard(primitive_count);
  begins_.reserve_discard(Offset{primitive_count} + 1);
  const auto counts = counts_.view(primitive_count);
  const auto begins = begins_.view(Offset{primitive_count} + 1);
  for_each(b, primitive_count, render::CountChunks<Source>{source, counts});
  exclusive_scan(b, Span<const Index>(counts), begins);
  const Offset items = fetch(b, begins.data + primitive_count);
  constexpr Offset kItemsPerPass = Offset{1} << 30;  // element numbers are 32-bit
  for (Offset first = 0; first < items; first += kItemsPerPass) {
    for_each(b, static_cast<Index>(std::min(items - first, kItemsPerPass)),
             render::DrawChunk<Source>{source, begins, first});
  }
}

template <class B, class Real>
Image Renderer<B, Real>::render(B& b, const BodyView<Real>& bodies,
                                Span<const ShapeRecord<Real>> shapes,
                                const MeshSetView<Real>& meshes, const PictureSettings& settings,
                                render::ColorRange* range) {
  const Extent extent = find_extent(b, bodies, shapes);
  const CameraSettings camera =
      settings.camera.automatic ? automatic_camera(b, bodies, extent, settings) : settings.camera;
  const double scene_size = extent.framed.empty() ? norm(camera.target - camera.position)
                                                  : std::max(extent.framed.diagonal(), 1e-12);
  const Vec3d focus = extent.framed.empty() ? camera.target
                      : extent.free.empty() ? extent.framed.center()
                                            : extent.free.center();

  const auto list = make_draw_list(b, bodies, shapes, meshes, camera.position, focus);
  static_assert(static_cast<int>(ColorBy::speed) == static_cast<int>(render::ColorMode::speed) &&
                static_cast<int>(ColorBy::size) == static_cast<int>(render::ColorMode::size) &&
                static_cast<int>(ColorBy::id) == static_cast<int>(render::ColorMode::id) &&
                static_cast<int>(ColorBy::group) == static_cast<int>(render::ColorMode::group));
  const render::ColorValue<Real> value{static_cast<render::ColorMode>(settings.color_by),
                                       bodies.velocity, bodies.radius};
  const render::ColorRange values =
      color_range(b, value, bodies.owned_count, settings, extent.mean_radius);
  if (range != nullptr) *range = values;
  color_.reserve_discard(bodies.count);
  for_each(b, bodies.count,
           render::ColorBodies<Real>{value, static_cast<float>(values.low),
                                     static_cast<float>(values.high), bodies.without_ghosts(),
                                     bodies.group, bodies.id, color_.view(bodies.count)});

  // A shadow sample is about as large as a sample of the picture when the scene fills it.
  const Vec3d to_light = render::key_light_direction(camera);
  const int light_side = std::clamp(3 * std::max(settings.width, settings.height) / 2, 256, 8192);
  const render::View light = render::light_view(extent.framed, to_light, light_side);
  light_samples_.reserve_discard(light.sample_count());
  const auto light_samples = light_samples_.view(light.sample_count());
  clear(b, light, light_samples, render::kNoDepth);
  draw(b, render::SolidSource<Real, std::uint32_t>{list, light, light_samples, true});

  // The window holds the rows of a band and those above and below that occlusion reads.
  render::View view = render::camera_view(camera, settings.width, settings.height, scene_size);
  constexpr int kMargin = 2 * render::kOcclusionReach;
  view.buffer_rows = static_cast<int>(std::min<Offset>(
      view.height, std::max<Offset>(sample_budget_ / view.width, kMargin + kLeastBandRows)));
  const int band_rows =
      view.buffer_rows == view.height
          ? view.height
          : (view.buffer_rows - kMargin) / render::kSupersampling * render::kSupersampling;
  samples_.reserve_discard(view.sample_count());
  const auto samples = samples_.view(view.sample_count());
  render::EdgeSource<Real> edge_source{list, view, samples, {}, 0.5f * render::kSupersampling};
  const bool has_edges = edge_source.primitive_count() > 0;
  if (has_edges) {
    edges_.reserve_discard(view.sample_count());
    edge_source.marks = edges_.view(view.sample_count());
  }
  rgb_.reserve_discard(3 * Offset{settings.width} * (band_rows / render::kSupersampling));

  const auto body_size =
      static_cast<float>(extent.mean_radius > 0 ? extent.mean_radius : 0.05 * scene_size);
  render::ShadePixel<Real> shade;
  shade.list = list;
  shade.view = view;
  shade.samples = samples;
  shade.edges = edge_source.marks;
  shade.color = color_.view(bodies.count);
  shade.body_taps = render::make_tap_disk<render::BodyTaps>();
  shade.wall_taps = render::make_tap_disk<render::WallTaps>();
  shade.shadow = {light, light_samples, render::Vec3f(view.origin - light.origin),
                  0.22f * body_size};
  shade.occlusion = {view, samples, 1.3f * body_size, 5.0f * body_size};
  shade.to_light = render::Vec3f(to_light);
  shade.sky_up = render::Vec3f(normalized(camera.up));
  shade.scene_size = static_cast<float>(scene_size);

  Image image;
  image.width = settings.width;
  image.height = settings.height;
  image.rgb.resize(3 * static_cast<std::size_t>(image.width) * image.height);
  view.row_end = 0;
  for (int begin = 0; begin < view.height; begin += band_rows) {
    const int end = std::min(begin + band_rows, view.height);
    view.row_begin = view.row_end;  // rows above were drawn for the bands before
    view.row_end = std::min(end + render::kOcclusionReach, view.height);
    clear(b, view, samples, render::kNothing);
    draw(b, render::SolidSource<Real, std::uint64_t>{list, view, samples, false});
    if (has_edges) {
      clear(b, view, edge_source.marks, std::uint8_t{0});
      edge_source.view = view;
      draw(b, edge_source);
    }
    shade.first_row = begin / render::kSupersampling;
    const Index pixel_count = settings.width * ((end - begin) / render::kSupersampling);
    shade.rgb = rgb_.view(3 * Offset{pixel_count});
    for_each(b, pixel_count, shade);
    download(b, Span<const std::uint8_t>(shade.rgb),
             image.rgb.data() + 3 * static_cast<std::size_t>(settings.width) * shade.first_row);
  }
  return image;
}

}  // namespace scree
