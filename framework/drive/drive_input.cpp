// Declarations of a drive file, and its way from text to checked laws.
#include "drive/drive_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "input/binder.hpp"
#include "input/curve_table.hpp"
#include "input/parameter_text.hpp"
#include "input/read_model.hpp"
#include "input/substitute.hpp"
#include "input/yaml_reader.hpp"
#include "kerf/measure.hpp"

namespace kerf {

namespace {

constexpr const char* plain_element = "{type: hex8, linear_viscosity: 0, quadratic_viscosity: 0}";

bool is_history(const PathInput& p) { return p.type == "history"; }

bool begins_at_zero(const std::vector<double>& strains) { return !strains.empty() && strains.front() == 0.0; }

bool ascends(const std::vector<double>& v) {
  return std::adjacent_find(v.begin(), v.end(), [](double a, double b) { return !(a < b); }) == v.end();
}

bool has_no_equal_neighbours(const std::vector<double>& strains) {
  return std::adjacent_find(strains.begin(), strains.end()) == strains.end();
}

/// How many of the lists that say where the path goes are given.
int ways_given(const PathInput& p) {
  return (p.strains.empty() ? 0 : 1) + (p.strain_rates.empty() ? 0 : 1) + (p.file.empty() ? 0 : 1);
}

}  // namespace

void ReferenceInput::describe(Schema<ReferenceInput>& s) {
  s.text(&ReferenceInput::file, "file", "CSV file with a heading, named relative to the drive file");
  s.text(&ReferenceInput::time, "time", "heading of the column of times in seconds").by_default("time_s");
  s.text(&ReferenceInput::label, "label", "how the picture calls it; by default the name of the file").optional();
  s.text_map(&ReferenceInput::columns, "columns",
             "heading in the file for columns of the driver; a heading that is the name of a column, or the name and "
             "its unit (`stress_xx_Pa`), need not be given")
      .optional();
  s.real(&ReferenceInput::tolerance, "tolerance", "-", non_negative,
         "greatest error of every column, over the greatest value of the column in the file; where neither this nor "
         "`tolerances` is given the file is drawn only")
      .optional();
  s.text_map(&ReferenceInput::tolerances, "tolerances", "the same of single columns").optional();
  s.text_map(&ReferenceInput::rms, "rms", "root mean square error that is allowed, by column").optional();
  s.integers(&ReferenceInput::skip, "skip", non_negative, "rows that are not compared, counted from 0").optional();
  s.integers(&ReferenceInput::loose, "loose", non_negative, "rows that are compared with `loose_tolerance` only")
      .optional();
  s.real(&ReferenceInput::loose_tolerance, "loose_tolerance", "-", non_negative, "tolerance of the rows in `loose`")
      .optional();
}

void PathInput::describe(Schema<PathInput>& s) {
  s.choice(&PathInput::type, "type",
           {"uniaxial_strain", "uniaxial_stress", "triaxial", "simple_shear", "volumetric", "history"},
           "what is strained: the x axis with the others held, the x axis with the lateral stress held, the same after "
           "an isotropic compression, x along y, all axes alike, or the deformation gradient of a file");
  s.text(&PathInput::name, "name", "name of the path in files and pictures; by default its type").optional();
  s.texts(&PathInput::materials, "materials", "materials that take this path; all where absent").optional();
  s.reals(&PathInput::strains, "strains", "-", any_value,
          "nominal strains between which the path goes in straight lines, from 0 on: change of length over initial "
          "length, negative in compression; in simple_shear the shear angle's tangent")
      .optional();
  s.reals(&PathInput::lateral_strains, "lateral_strains", "-", any_value,
          "nominal strains of the y and z axes at the same moments, for uniaxial_strain")
      .optional();
  s.real(&PathInput::rate, "rate", "s-1", positive, "nominal strain rate, its magnitude").optional();
  s.reals(&PathInput::times, "times", "s", non_negative, "times of the strains, in place of a rate, or of strain_rates")
      .optional();
  s.reals(&PathInput::strain_rates, "strain_rates", "s-1", any_value,
          "nominal strain rates at the times, linear between them, in place of strains")
      .optional();
  s.reals(&PathInput::lateral_strain_rates, "lateral_strain_rates", "s-1", any_value,
          "the same of the y and z axes, for uniaxial_strain")
      .optional();
  s.real(&PathInput::lateral_stress, "lateral_stress", "Pa", any_value,
         "lateral stress that uniaxial_stress holds, positive in tension")
      .by_default("0 Pa");
  s.real(&PathInput::confinement, "confinement", "Pa", positive,
         "triaxial: pressure up to which all axes are compressed alike before the strains begin, and which the lateral "
         "stress keeps")
      .optional();
  s.real(&PathInput::isotropic_until, "isotropic_until", "s", positive,
         "triaxial, in place of confinement: time until which all axes follow the strains alike")
      .optional();
  s.text(&PathInput::file, "file",
         "history: CSV file with the column time_s and any of F_xx, F_xy ... F_zz, the components of the deformation "
         "gradient; what is missing is that of the undeformed element")
      .optional();
  s.integer(&PathInput::steps, "steps", between(1.0, 1e7), "time steps of the whole path, at least").by_default("1000");
  s.integer(&PathInput::rows, "rows", between(1.0, 1e6), "rows of the CSV file that is written, about")
      .by_default("200");
  s.text_map(&PathInput::initial_state, "initial_state",
             "values of state variables before the first step, and `specific_energy`, with units")
      .optional();
  s.choice(&PathInput::after_failure, "after_failure", {"stop", "go_on"},
           "whether the path ends where erosion would delete the element")
      .by_default("stop");
  s.block_list(&PathInput::references, "references", "tables with which the path is compared").optional();
  s.rule("type",
         "a history needs the key `file` and none of strains, times and rates; every other path needs strains "
         "or strain_rates, and no file",
         [](const PathInput& p) {
           return ways_given(p) == 1 && is_history(p) == !p.file.empty() &&
                  (!is_history(p) || (p.times.empty() && p.rate == 0.0));
         });
  s.rule("strains",
         "strains begin at 0 and have at least two values, each different from the one before where a rate is "
         "given",
         [](const PathInput& p) {
           return p.strains.empty() || (p.strains.size() > 1 && begins_at_zero(p.strains) &&
                                        (!p.times.empty() || has_no_equal_neighbours(p.strains)));
         });
  s.rule("strains", "a nominal strain of -1 or less leaves nothing of the element", [](const PathInput& p) {
    const auto possible = [](const std::vector<double>& all) {
      return std::all_of(all.begin(), all.end(), [](double e) { return e > -1.0; });
    };
    return p.type == "simple_shear" || (possible(p.strains) && possible(p.lateral_strains));
  });
  s.rule("rate", "strains take either a rate or times; strain_rates take times", [](const PathInput& p) {
    return (p.strains.empty() || (p.rate > 0.0) == p.times.empty()) &&
           (p.strain_rates.empty() || (p.rate == 0.0 && !p.times.empty()));
  });
  s.rule("times", "times begin at 0, ascend, and are as many as the strains or strain rates", [](const PathInput& p) {
    return p.times.empty() || (p.times.front() == 0.0 && ascends(p.times) && p.times.size() > 1 &&
                               p.times.size() == p.strains.size() + p.strain_rates.size());
  });
  s.rule(
      "lateral_strains",
      "lateral strains, or their rates, are for uniaxial_strain, beside strains or rates of the same number; strains "
      "begin at 0",
      [](const PathInput& p) {
        const bool fits = (p.lateral_strains.empty() || begins_at_zero(p.lateral_strains)) &&
                          (p.lateral_strains.empty() || p.lateral_strains.size() == p.strains.size()) &&
                          (p.lateral_strain_rates.empty() || p.lateral_strain_rates.size() == p.strain_rates.size());
        return (p.lateral_strains.empty() && p.lateral_strain_rates.empty()) || (p.type == "uniaxial_strain" && fits);
      });
  s.rule("confinement", "a triaxial path takes either confinement or isotropic_until, and no other path takes them",
         [](const PathInput& p) {
           const int given = (p.confinement > 0.0 ? 1 : 0) + (p.isotropic_until > 0.0 ? 1 : 0);
           return given == (p.type == "triaxial" ? 1 : 0);
         });
  s.rule("isotropic_until", "isotropic_until needs the times of the strains and has to be one of them",
         [](const PathInput& p) {
           return p.isotropic_until == 0.0 ||
                  std::find(p.times.begin(), p.times.end(), p.isotropic_until) != p.times.end();
         });
  s.rule("lateral_stress", "a lateral stress can be held by uniaxial_stress only",
         [](const PathInput& p) { return p.type == "uniaxial_stress" || p.lateral_stress == 0.0; });
}

void PointsInput::describe(Schema<PointsInput>& s) {
  s.text(&PointsInput::file, "file", "CSV file with the points, named relative to the drive file");
  s.texts(&PointsInput::columns, "columns",
          "columns of the file, by their names in the heading or their numbers from 1: first that of x, then of y")
      .by_default("[1, 2]");
  s.real(&PointsInput::x_scale, "x_scale", "-", any_value, "factor of x that makes SI units").by_default("1");
  s.real(&PointsInput::y_scale, "y_scale", "-", any_value, "factor of y that makes SI units").by_default("1");
  s.text(&PointsInput::label, "label", "how the picture calls them; by default the name of the file").optional();
  s.rule("columns", "two columns are needed, of x and of y",
         [](const PointsInput& p) { return p.columns.size() == 2; });
}

void PictureInput::describe(Schema<PictureInput>& s) {
  s.text(&PictureInput::name, "name", "name of its file; by default Y_over_X").optional();
  s.text(&PictureInput::x, "x", "column along the axis").by_default("strain");
  s.text(&PictureInput::y, "y", "column upwards");
  s.texts(&PictureInput::paths, "paths", "paths that are drawn; all where absent").optional();
  s.block_list(&PictureInput::points, "points", "measured points that are laid under").optional();
}

void DriveInput::describe(Schema<DriveInput>& s) {
  s.text(&DriveInput::title, "title", "what is driven, for pictures").optional();
  s.texts(&DriveInput::plugins, "plugins", "shared libraries to load, named relative to this file").optional();
  s.texts(&DriveInput::library, "library", "folders of further sets of the material library").optional();
  s.text_map(&DriveInput::parameters, "parameters", "numbers that the file may name as ${name}").optional();
  s.block_map(&DriveInput::curves, "curves", "named functions of time").optional();
  s.block_map(&DriveInput::materials, "materials", "materials that are driven, as in an input file");
  s.real(&DriveInput::size, "size", "m", positive, "edge of the cube that is driven").by_default("1 mm");
  s.plugin(&DriveInput::element, "element", "element", "element technology, by default without bulk viscosity")
      .by_default(plain_element);
  s.block_list(&DriveInput::paths, "paths", "paths of deformation; every material takes each of them");
  s.block_list(&DriveInput::pictures, "pictures",
               "pictures; by default the von Mises stress over the strain, and the pressure over the density")
      .optional();
}

namespace {

class Reader {
 public:
  Reader(const std::string& file_name, const Registry& registry) : file_name_(file_name), registry_(registry) {}

  std::unique_ptr<DriveInput> read(const std::string& bytes, const std::vector<std::string>& overrides,
                                   const std::vector<std::string>& library) {
    std::optional<Node> root = read_yaml(file_name_, bytes, diagnostics_);
    if (!root) throw InputError(diagnostics_.errors());
    for (const std::string& text : overrides) apply_override(*root, text, diagnostics_);
    substitute_parameters(*root, diagnostics_);
    const Origin top{std::make_shared<const std::string>(file_name_), 1, 1};
    if (root->is_nothing()) {
      diagnostics_.error(top, "the file is empty; expected at least the keys materials and paths");
      diagnostics_.throw_if_errors();
    }
    const std::string folder = std::filesystem::path(file_name_).parent_path().string();
    input_->library_uses = expand_library(*root, folder, library, read_text_file, diagnostics_);
    origins_.add("", top);
    CurveTable curves(input_->curves, folder, read_text_file, origins_, diagnostics_);
    const Entry* parameters = std::as_const(*root).find("parameters");
    Binder binder(registry_, diagnostics_, origins_, &curves, parameters ? &parameters->value : nullptr);
    binder.bind_block(Schema<DriveInput>::described<DriveInput>(), *root, input_.get(), "", top);
    curves.finish();
    diagnostics_.throw_if_errors();
    add_what_a_model_has(binder, *root, top);
    name_paths();
    validate(*input_, origins_, diagnostics_);
    check_names();
    diagnostics_.throw_if_errors();
    input_->warnings = diagnostics_.warnings();
    return std::move(input_);
  }

 private:
  /// One part for each material, and the defaults of the blocks that a drive file does not have: the checks of laws
  /// are those of an input file.
  void add_what_a_model_has(Binder& binder, const Node& root, const Origin& top) {
    const Entry* element = root.find("element");
    const std::string box =
        fmt::format("{{type: block, size: [{0:.17g}, {0:.17g}, {0:.17g}], cells: [1, 1, 1]}}", input_->size);
    for (const auto& material : input_->materials) {
      Node part = node_from_text(fmt::format("{{mesh: {}, material: {}}}", box, material->name), top, diagnostics_);
      part.entries.push_back(
          {"element", top, element ? element->value : node_from_text(plain_element, top, diagnostics_)});
      input_->parts.push_back(std::make_unique<PartInput>());
      input_->parts.back()->name = material->name;
      binder.bind_block(Schema<PartInput>::described<PartInput>(), part, input_->parts.back().get(),
                        "parts." + material->name, top);
    }
    const Node nothing = node_from_text("{}", top, diagnostics_);
    binder.bind_block(Schema<BalanceInput>::described<BalanceInput>(), nothing, &input_->balance, "balance", top);
    binder.bind_block(Schema<OutputInput>::described<OutputInput>(), nothing, &input_->output, "output", top);
    binder.bind_block(Schema<ChecksInput>::described<ChecksInput>(), nothing, &input_->checks, "checks", top);
    input_->precision = "double";
    diagnostics_.throw_if_errors();
  }

  void name_paths() {
    for (std::size_t i = 0; i < input_->paths.size(); ++i) {
      PathInput& p = *input_->paths[i];
      if (p.name.empty()) p.name = p.type;
      input_->origins[&p] = origins_.find(fmt::format("paths[{}]", i)).text();
    }
  }

  void check_names() {
    std::set<std::string> names;
    std::vector<std::string> materials;
    for (const auto& m : input_->materials) materials.push_back(m->name);
    for (std::size_t i = 0; i < input_->paths.size(); ++i) {
      const PathInput& p = *input_->paths[i];
      const Origin where = origins_.find(fmt::format("paths[{}].name", i));
      if (p.name.find('/') != std::string::npos || p.name.front() == '.')
        diagnostics_.error(where, fmt::format("a path is called \"{}\"; expected a name that a file can have", p.name));
      if (!names.insert(p.name).second)
        diagnostics_.error(
            where, fmt::format("two paths are called \"{}\"; expected the key `name` with another name", p.name));
      for (std::size_t k = 0; k < p.materials.size(); ++k)
        if (std::find(materials.begin(), materials.end(), p.materials[k]) == materials.end())
          diagnostics_.error(origins_.find(fmt::format("paths[{}].materials[{}]", i, k)),
                             fmt::format("there is no material \"{}\"{}", p.materials[k],
                                         suggestion(p.materials[k], materials, "the materials")));
    }
    for (std::size_t i = 0; i < input_->pictures.size(); ++i)
      for (std::size_t k = 0; k < input_->pictures[i]->paths.size(); ++k)
        if (const std::string& name = input_->pictures[i]->paths[k]; !names.contains(name))
          diagnostics_.error(origins_.find(fmt::format("pictures[{}].paths[{}]", i, k)),
                             fmt::format("there is no path \"{}\"{}", name,
                                         suggestion(name, {names.begin(), names.end()}, "the paths")));
    if (input_->paths.empty()) diagnostics_.error(origins_.find("paths"), "there are no paths; expected at least one");
  }

  const std::string& file_name_;
  const Registry& registry_;
  Diagnostics diagnostics_;
  OriginMap origins_;
  std::unique_ptr<DriveInput> input_ = std::make_unique<DriveInput>();
};

}  // namespace

const Description& drive_description() {
  static const Description described = [] {
    Description d = Schema<DriveInput>::described<DriveInput>();
    d.name = "drive";
    d.summary = "the whole file of `kerf drive`";
    return d;
  }();
  return described;
}

std::unique_ptr<DriveInput> read_drive_input(const std::string& file_name, const std::string& bytes,
                                             const std::vector<std::string>& overrides, const Registry& registry,
                                             const std::vector<std::string>& library) {
  return Reader(file_name, registry).read(bytes, overrides, library);
}

}  // namespace kerf
