#pragma once
// Every reader of files behind one function that takes bytes: libFuzzer and the mutation
// tests call it.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace scree::fuzz {

/// scene, particles, mesh, heights, motion, problem, checkpoint, fclib and, where there is tinyxml2, urdf.
const std::vector<std::string>& readers();

/// Gives bytes to a reader as the contents of a file; for problem, checkpoint and fclib as edits of
/// one of the seeds (hdf5_edits.h). Refusals are what readers are for: InputError is caught, as is
/// RunError of the steps that follow a checkpoint. Everything else is a fault and gets out.
/// @return  false when they were refused
bool read_bytes(const std::string& reader, std::string_view bytes);

/// The files that mutations start from, by name; for the HDF5 readers those that edits are made in.
std::vector<std::filesystem::path> seeds(const std::string& reader);

/// The bytes of a file.
std::string contents(const std::filesystem::path& path);

}  // namespace scree::fuzz
