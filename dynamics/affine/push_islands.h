#pragma once
// Bodies that a push may reach: those that are near each other, and so on, and those that joints hold together.

#include <functional>
#include <vector>

#include "dynamics/affine/affine_setup.h"

namespace scree::affine {

/// By body, whether it is one of some or a push on one of them may reach it.
/// @param near  pairs of bodies that may touch. @param begins  which bodies are pushed
/// @param passes  which pass a push on; others are not reached. Fixed bodies never pass one on
std::vector<bool> reached_by_push(const AffineSetup& setup, const std::vector<BodyPair>& near,
                                  const std::function<bool(std::size_t body)>& begins,
                                  const std::function<bool(std::size_t body)>& passes);

/// Bodies that prescribed ones may push.
std::vector<bool> bodies_near_led(const AffineSetup& setup, const std::vector<BodyPair>& near);

/// Stiff bodies that share the momentum of an impact. @param is_hit  by row, those that were hit
std::vector<bool> bodies_near_hit(const AffineSetup& setup, const std::vector<BodyPair>& near,
                                  const std::vector<Index>& is_hit);

}  // namespace scree::affine
