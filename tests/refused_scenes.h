#pragma once
// Public scenes of affine bodies that are refused.

namespace scree {

/// Bodies without volume: flat ones, and those of points or edges. Below the folder of the shared scenes.
inline constexpr const char* kRefusedScenes[] = {
    "fixtures/3D/codimensional/edges/chain-net-4x4.json",
    "fixtures/3D/codimensional/edges/tet-plane.json",
    "fixtures/3D/codimensional/points/tet-hole.json",
    "fixtures/3D/codimensional/points/tet-plane.json",
    "fixtures/3D/compactor/single-cube.json",
    "fixtures/3D/friction/card-house/card-house-2-levels.json",
    "fixtures/3D/friction/card-house/card-house-3-levels-falling-blocks.json",
    "fixtures/3D/friction/card-house/card-tent.json",
};

}  // namespace scree
