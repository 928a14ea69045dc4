// Puts a model into the state that a frame of a run's results shows.
#pragma once

#include <cstdint>
#include <string>

#include "model/model.hpp"

namespace kerf {

struct FrameState {
  std::int64_t frame = 0;
  double time = 0.0;  // [s]
};

/// Number of frames of the results in a folder. Throws InputError where there are none. Not collective.
std::int64_t frames_of(const std::string& folder);

/// Moves the nodes to their places in a frame and retires the elements that are dead there; velocities and the state of
/// laws stay as they are. Pre: the model was generated from the input of the run; no element is dead that lives in the
/// frame; the frame exists. Throws InputError, on all ranks, where the results are of another model. Collective.
FrameState take_frame(Model& model, const std::string& folder, std::int64_t frame);

}  // namespace kerf
