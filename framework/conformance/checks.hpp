// The conformance checks. Each adds one or more rows to the verdicts; none throws for what a plugin does wrong.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "conformance/samples.hpp"
#include "conformance/verdicts.hpp"

namespace kerf {

/// "documentation": what can be checked of it.
void check_documentation(const Description& d, Verdicts& out);
/// "sample" and "ranges": the sample is taken, and what is outside of the ranges refused. False where the type cannot
/// be made, so that nothing else can be tested.
bool check_parameters(const Registry& registry, const TypeSample& sample, Verdicts& out);

/// "lanes", "finite": blocks of random points.
void check_blocks(const Registry& registry, const TypeSample& sample, Verdicts& out);
/// "single_precision", "objectivity", "rotated_path", "convergence": one element along a path.
void check_paths(const Registry& registry, const TypeSample& sample, Verdicts& out);
/// "energy": closed cycles of strain.
void check_energy(const Registry& registry, const TypeSample& sample, Verdicts& out);
/// "moduli": the tangent of the law against the moduli that it returns.
void check_moduli(const Registry& registry, const TypeSample& sample, Verdicts& out);
/// "restart", "hidden_state".
void check_state(const Registry& registry, const TypeSample& sample, Verdicts& out);
/// "cost".
void check_cost(const Registry& registry, const TypeSample& sample, Verdicts& out);
/// "vectorised". `library` is empty for what is built in.
void report_vectorisation(const Registry& registry, const TypeSample& sample, const std::string& library,
                          Verdicts& out);

/// "mesh": volumes, numbering, faces.
void check_mesh(const Registry& registry, const TypeSample& sample, Verdicts& out);

/// How `kerf run` is called: a folder for files, which is there, and the plugins that are loaded.
struct RunPlace {
  std::string folder;
  std::vector<std::string> plugins;
};
/// "migration" and "run_restart" of laws, elements and partitioners, in a model that is made of the samples.
void check_runs(const Registry& registry, const std::vector<const TypeSample*>& samples, const RunPlace& place,
                Verdicts& out);
/// The same with a whole input, which shows what `types` do; each gets its rows.
void check_input(const std::vector<std::string>& types, const std::string& input, const RunPlace& place, Verdicts& out);

/// The sentence of an exception, with the place of a law error left out.
std::string sentence_of(const std::exception& e);
/// Place of the largest number; NaN counts as larger than all.
std::size_t worst_of(const std::vector<double>& values);

}  // namespace kerf
