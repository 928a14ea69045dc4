// When fronts that laws describe (detonations) arrive at the elements of the undeformed mesh.
#pragma once

#include "model/model.hpp"

namespace kerf {

/// Solves |grad t| = 1/speed inside of the parts whose laws ask for it, and sets their state variable. Times are exact
/// where an origin is seen in a straight line through one material; elsewhere they are late by a share of the cells'
/// size. The bits do not depend on the ranks: see arrival.cpp. Pre: the nodes are assembled. Collective.
void find_arrivals(Model& model);

}  // namespace kerf
