// The keys of a height field: a table, a picture or rows of heights, and the rectangle that they are over.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "host/scene/height_field.h"
#include "host/scene_reader/parts.h"

namespace scree::reader {
namespace {

void refuse_key(const Node& node, const char* key, const char* why) {
  if (const auto found = node.find(key)) found->fail(why);
}

std::array<double, 2> read_extent(const Node& node) {
  const char* expected = "must be two full edge lengths [x, y], positive [m]";
  const Node extent = node.at("extent", expected);
  if (!extent.json().is_array() || extent.json().size() != 2) extent.refuse(expected);
  std::array<double, 2> edges{};
  for (std::size_t k = 0; k < 2; ++k) edges[k] = extent.elements()[k].number(kPositive, "m");
  return edges;
}

HeightGrid read_rows(const Node& rows, double scale, double offset) {
  HeightGrid grid;
  for (const Node& row : rows.elements()) {
    const std::vector<Node> values = row.elements();
    if (grid.rows == 0) grid.columns = values.size();
    if (values.size() != grid.columns)
      row.fail(fmt::format("{} heights, but the rows before have {}", values.size(), grid.columns));
    if (grid.heights.size() + values.size() > kMostHeights)
      row.fail(fmt::format("more than {} heights", kMostHeights));
    for (const Node& value : values)
      grid.heights.push_back(offset + scale * value.number(kFinite, "m"));
    ++grid.rows;
  }
  if (grid.rows < 2 || grid.columns < 2)
    rows.fail(fmt::format("{} x {} heights, must be 2 x 2 or more", grid.rows, grid.columns));
  return grid;
}

std::string extension_of(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Heights of an entry; `key` is what tells them apart from those of others.
HeightGrid read_heights(const Node& node, std::string& key) {
  const auto file = node.find("file");
  const auto heights = node.find("heights");
  if (file && heights) heights->fail("give either heights or a file");
  if (file && extension_of(file->text()) == ".png") {
    for (const char* other : {"height_scale", "height_offset"})
      refuse_key(node, other, "only tables have this key; a picture has height_range");
    const auto [low, high] =
        node.at("height_range", "must be the heights of black and of white [m]").interval("m");
    key = fmt::format("{}|{}|{}", file->file().string(), low, high);
    return file->from_file([low = low, high = high](const auto& path) {
      return read_height_picture(path, low, high);
    });
  }
  refuse_key(node, "height_range", "only pictures have this key; a table has height_scale");
  double scale = 1, offset = 0;
  node.read("height_scale", scale, kPositive, "m");
  node.read("height_offset", offset, kFinite, "m");
  const Node source =
      heights ? *heights
              : node.at("file", "must be the name of a .csv or .png file, or give heights [m]");
  key = fmt::format("{}|{}|{}", heights ? heights->json().dump() : source.file().string(), scale,
                    offset);
  if (heights) return read_rows(source, scale, offset);
  if (extension_of(source.text()) != ".csv") source.refuse("the name must end in .csv or .png");
  return source.from_file([&](const auto& path) { return read_height_table(path, scale, offset); });
}

}  // namespace

int read_height_field(const Node& node, Draft& draft) {
  const std::array<double, 2> extent = read_extent(node);
  double thickness = 0.1 * std::max(extent[0], extent[1]);
  node.read("thickness", thickness, kPositive, "m");
  std::string key;
  const HeightGrid grid = read_heights(node, key);
  key = fmt::format("height_field|{}|{}|{}|{}", extent[0], extent[1], thickness, key);
  const auto [entry, is_new] =
      draft.meshes.emplace(key, static_cast<int>(draft.scene.meshes.size()));
  if (!is_new) return entry->second;
  const Node source = node.at(node.has("heights") ? "heights" : "file", "");
  try {
    draft.scene.meshes.push_back(height_field_mesh(
        node.has("heights") ? "heights" : source.file().string(), grid, extent, thickness));
  } catch (const std::invalid_argument& error) {
    source.fail(error.what());
  }
  return entry->second;
}

}  // namespace scree::reader
