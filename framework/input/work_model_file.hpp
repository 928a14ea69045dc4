// Reads the file of a work model, which holds seconds as `kerf bench --calibrate` has measured them.
#pragma once

#include <string>

#include "core/diagnostics.hpp"
#include "input/curve_table.hpp"
#include "input/work_model.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// Reads a file of `kerf bench --calibrate`. Mistakes go to `diagnostics`, with their place in the file; `where` is the
/// place that names the file.
WorkModel read_work_model(const std::string& path, const Origin& where, const FileReader& read,
                          const Registry& registry, Diagnostics& diagnostics);

}  // namespace kerf
