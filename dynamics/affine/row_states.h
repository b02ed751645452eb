#pragma once
// States of bodies with a row as checkpoints have them: four vectors each, in the order of rows.

#include <vector>

#include "dynamics/affine/affine_setup.h"
#include "dynamics/model_errors.h"
#include "kernels/backend/backend.h"

namespace scree::affine {

/// Positions or velocities. @param by_body  of all bodies  @return nodes of those with a row
template <class B>
std::vector<Vec3d> row_states(B& b, const AffineSetup& setup, Buffer<B, AffineVec>& by_body) {
  const std::vector<AffineVec> all = download(b, by_body.view());
  std::vector<Vec3d> out;
  for (const Index body : setup.body_of_row)
    for (const Vec3d& node : all[static_cast<std::size_t>(body)].node) out.push_back(node);
  return out;
}

/// @param by_body  in and out: bodies without a row stay. @throws InputError for states of another number of bodies
template <class B>
void restore_row_states(B& b, const AffineSetup& setup, const std::vector<Vec3d>& states,
                        Buffer<B, AffineVec>& by_body) {
  const std::size_t rows = setup.body_of_row.size();
  if (states.size() != 4 * rows) throw_wrong_body_count(states.size() / 4, rows);
  std::vector<AffineVec> all = download(b, by_body.view());
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t k = 0; k < 4; ++k)
      all[static_cast<std::size_t>(setup.body_of_row[row])].node[k] = states[4 * row + k];
  upload(b, all.data(), by_body.view());
}

}  // namespace scree::affine
