// Small models for tests, written as input files, and random deletion of their elements during a run.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "erosion/erosion.hpp"
#include "input/model_input.hpp"
#include "model/ledger.hpp"
#include "model/model.hpp"
#include "plugin/registry.hpp"

namespace kerf::test {

/// The built-in plugins and two for tests: the erosion criterion `fuse`, which deletes an element when its state
/// variable `fuse_cycles`, counted down by one every cycle, reaches zero (it starts at 1e9); and the element `limp`,
/// which has no stiffness, takes any shape and has a stable step of 1e-7 s, for motion that a test prescribes.
const Registry& scene_registry();

/// A checked model input from the text of an input file. Throws InputError with all mistakes.
std::unique_ptr<ModelInput> scene(const std::string& yaml);

/// Generates a model as a run does, but leaves its elements where they were generated: no partitioner is asked.
void generate(Model& model, const ModelInput& input);

/// Where the generator of a part puts a node of the undeformed model [m]. Pre: no parts are joined.
Vec3 generated_position(const Model& model, std::int64_t node);

/// Sets the fuse of every element: `cycles(id)` is the number of cycles that it has left. Needs `fuse` as a
/// criterion of every part's material.
void light_fuses(Model& model, const std::function<double(std::int64_t)>& cycles);

/// Deletes live elements as the erosion phase of a step does: nodes become free, the surface opens, stores are
/// compacted where worth it. Needs an erosion block in the material of every part. Collective.
void delete_elements(Model& model, Erosion& erosion, Ledger& ledger, const std::function<bool(std::int64_t)>& dies);

/// Owners for migrate(), one per live element of this rank: `owner(id)` is a rank.
std::vector<int> owners_of_live(const Model& model, const std::function<int(std::int64_t)>& owner);

/// A number that looks random but is a function of its arguments alone, hence the same on all ranks; in [0, 1).
double scatter(std::uint64_t seed, std::uint64_t item);

}  // namespace kerf::test
