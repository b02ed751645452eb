#pragma once
// Scene files: JSON with comments. The keys, their units and ranges are in scenes/schema.json. Scenes of
// rigid-ipc and of Autodesk's Affine Body Dynamics are read too.

#include <filesystem>
#include <string>
#include <vector>

#include "host/scene.h"

namespace scree {

/// Reads and checks a scene. Files named in it are relative to its directory.
/// @param overrides  `key.path=value` each, applied before reading: `solver.max_iterations=50`,
///                   `particles.0.count=500`; the value is JSON or a bare string
/// @throws InputError "<file>: <key path>: <value> is not allowed: <expected>", or with the line
///         and column of broken JSON
/// @param notes  gets what files that the scene names came in as, and what of them is not represented
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {},
                 std::vector<std::string>* notes = nullptr);

/// The same for a text already in memory.
/// @param file_name       how messages name it
/// @param base_directory  where files named in the scene are
Scene parse_scene(const std::string& text, const std::string& file_name,
                  const std::filesystem::path& base_directory,
                  const std::vector<std::string>& overrides = {},
                  std::vector<std::string>* notes = nullptr);

/// What is found wrong with a scene after it was read, as read_scene() says it: with the file, and "(overridden)" where an override
/// gave the value. @param fault  "<key path>: ..."
std::string scene_fault(const std::filesystem::path& file,
                        const std::vector<std::string>& overrides, const std::string& fault);

/// The document that read_scene reads, with overrides applied and without comments: the record of
/// what was run. @throws InputError
std::string scene_text(const std::filesystem::path& file,
                       const std::vector<std::string>& overrides = {});

}  // namespace scree
