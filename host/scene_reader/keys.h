#pragma once
// The keys a scene file may hold, in one place: the reader refuses others, and a test compares
// them with scenes/schema.json.

#include <string>
#include <vector>

namespace scree {

/// Keys of one kind of object in a scene file.
struct KeyTable {
  std::string object;  ///< its name under $defs in the schema; "scene" is the document itself
  std::vector<std::string> keys;
};

/// All tables.
const std::vector<KeyTable>& scene_key_tables();

/// Keys of bodies that say something about their shape, each once.
std::vector<std::string> shape_keys();

/// Keys of entries of `particles` but for those that say something about a shape alone.
const std::vector<std::string>& own_particle_keys();

/// The table of that name, which must exist.
const KeyTable& scene_keys(const std::string& object);

}  // namespace scree
