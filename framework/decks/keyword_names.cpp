// Names of keywords: numbers of materials, short names, options, and the keywords that change no result.
#include <algorithm>
#include <array>
#include <utility>

#include "core/diagnostics.hpp"
#include "decks/keyword_table.hpp"

namespace kerf::decks {
namespace {

using NamePair = std::pair<std::string_view, std::string_view>;

/// Other names of keywords.
constexpr NamePair other_names[] = {
    {"SET_NODE", "SET_NODE_LIST"},
    {"SET_PART", "SET_PART_LIST"},
    {"SET_SOLID_LIST", "SET_SOLID"},
    {"SET_NODE_GENERATE", "SET_NODE_LIST_GENERATE"},
    {"SET_PART_GENERATE", "SET_PART_LIST_GENERATE"},
    {"BOUNDARY_SPC", "BOUNDARY_SPC_NODE"},
    {"MAT_MOONEY_RIVLIN_RUBBER", "MAT_MOONEY-RIVLIN_RUBBER"},
    {"EOS_IGNITION_AND_GROWTH", "EOS_IGNITION_AND_GROWTH_OF_REACTION_IN_HE"},
};

/// Numbers of materials and equations of state, as MAT_nnn and EOS_nnn.
constexpr NamePair numbers[] = {
    {"MAT_1", "MAT_ELASTIC"},
    {"MAT_3", "MAT_PLASTIC_KINEMATIC"},
    {"MAT_5", "MAT_SOIL_AND_FOAM"},
    {"MAT_6", "MAT_VISCOELASTIC"},
    {"MAT_8", "MAT_HIGH_EXPLOSIVE_BURN"},
    {"MAT_9", "MAT_NULL"},
    {"MAT_10", "MAT_ELASTIC_PLASTIC_HYDRO"},
    {"MAT_11", "MAT_STEINBERG"},
    {"MAT_12", "MAT_ISOTROPIC_ELASTIC_PLASTIC"},
    {"MAT_13", "MAT_ISOTROPIC_ELASTIC_FAILURE"},
    {"MAT_14", "MAT_SOIL_AND_FOAM_FAILURE"},
    {"MAT_15", "MAT_JOHNSON_COOK"},
    {"MAT_16", "MAT_PSEUDO_TENSOR"},
    {"MAT_18", "MAT_POWER_LAW_PLASTICITY"},
    {"MAT_20", "MAT_RIGID"},
    {"MAT_24", "MAT_PIECEWISE_LINEAR_PLASTICITY"},
    {"MAT_25", "MAT_GEOLOGIC_CAP_MODEL"},
    {"MAT_26", "MAT_HONEYCOMB"},
    {"MAT_27", "MAT_MOONEY-RIVLIN_RUBBER"},
    {"MAT_57", "MAT_LOW_DENSITY_FOAM"},
    {"MAT_63", "MAT_CRUSHABLE_FOAM"},
    {"MAT_72", "MAT_CONCRETE_DAMAGE"},
    {"MAT_72R3", "MAT_CONCRETE_DAMAGE_REL3"},
    {"MAT_84", "MAT_WINFRITH_CONCRETE"},
    {"MAT_96", "MAT_BRITTLE_DAMAGE"},
    {"MAT_98", "MAT_SIMPLIFIED_JOHNSON_COOK"},
    {"MAT_106", "MAT_ELASTIC_VISCOPLASTIC_THERMAL"},
    {"MAT_107", "MAT_MODIFIED_JOHNSON_COOK"},
    {"MAT_110", "MAT_JOHNSON_HOLMQUIST_CERAMICS"},
    {"MAT_111", "MAT_JOHNSON_HOLMQUIST_CONCRETE"},
    {"MAT_120", "MAT_GURSON"},
    {"MAT_123", "MAT_MODIFIED_PIECEWISE_LINEAR_PLASTICITY"},
    {"MAT_140", "MAT_VACUUM"},
    {"MAT_159", "MAT_CSCM"},
    {"MAT_193", "MAT_DRUCKER_PRAGER"},
    {"MAT_224", "MAT_TABULATED_JOHNSON_COOK"},
    {"MAT_272", "MAT_RHT"},
    {"EOS_1", "EOS_LINEAR_POLYNOMIAL"},
    {"EOS_2", "EOS_JWL"},
    {"EOS_4", "EOS_GRUNEISEN"},
    {"EOS_5", "EOS_RATIO_OF_POLYNOMIALS"},
    {"EOS_7", "EOS_IGNITION_AND_GROWTH_OF_REACTION_IN_HE"},
    {"EOS_8", "EOS_TABULATED_COMPACTION"},
    {"EOS_9", "EOS_TABULATED"},
    {"EOS_12", "EOS_IDEAL_GAS"},
    {"EOS_19", "EOS_MURNAGHAN"},
};

/// Keywords that code of its own reads.
constexpr std::string_view read_names[] = {
    "KEYWORD",
    "END",
    "NODE",
    "ELEMENT_SOLID",
    "PARAMETER",
    "CASE",
    "CASE_BEGIN",
    "CASE_END",
    "PARAMETER_EXPRESSION",
    "PARAMETER_LOCAL",
    "INCLUDE",
    "INCLUDE_PATH",

    "INCLUDE_PATH_RELATIVE",
    "PARAMETER_EXPRESSION_LOCAL",
    "PARAMETER_MUTABLE",
};

/// Keywords that change no result of a run: output, resources, comments.
constexpr std::string_view noted_names[] = {
    "COMMENT",
    "CONTROL_OUTPUT",
    "CONTROL_PARALLEL",
    "CONTROL_CPU",
    "CONTROL_MPP_IO_NOD3DUMP",
    "CONTROL_MPP_IO_NODUMP",
    "CONTROL_MPP_IO_NOFULL",
    "CONTROL_MPP_IO_LSTC_REDUCE",
    "CONTROL_MPP_IO_SWAPBYTES",
    "CONTROL_MPP_DECOMPOSITION_AUTOMATIC",
    "CONTROL_MPP_DECOMPOSITION_NUMPROC",
    "CONTROL_MPP_DECOMPOSITION_METHOD",
    "CONTROL_MPP_DECOMPOSITION_TRANSFORMATION",
    "CONTROL_MPP_CONTACT_GROUPABLE",
    "CONTROL_MPP_PFILE",
    "CONTROL_STRUCTURED",
    "CONTROL_STRUCTURED_TERM",
    "CONTROL_DEBUG",
    "CONTROL_CHECK_SHELL",
    "CONTROL_SHELL",
    "SECTION_NULL",
    "PART_ANNOTATION",
    "INTERFACE_SPRINGBACK_LSDYNA",
};

/// Keywords of LS-DYNA that the reader does not know more of than their names, and that decks for solids hold.
constexpr std::string_view foreign_names[] = {
    "AIRBAG_SIMPLE_PRESSURE_VOLUME",
    "ALE_MULTI-MATERIAL_GROUP",
    "ALE_REFERENCE_SYSTEM_GROUP",
    "CONTROL_ALE",
    "BOUNDARY_CYCLIC",
    "BOUNDARY_TEMPERATURE_SET",
    "BOUNDARY_CONVECTION_SET",
    "BOUNDARY_FLUX_SET",
    "BOUNDARY_RADIATION_SET",
    "BOUNDARY_PRESCRIBED_ORIENTATION_RIGID",
    "BOUNDARY_SPC_SYMMETRY_PLANE",
    "CONSTRAINED_EXTRA_NODES_NODE",
    "CONSTRAINED_EXTRA_NODES_SET",
    "CONSTRAINED_GLOBAL",
    "CONSTRAINED_INTERPOLATION",
    "CONSTRAINED_JOINT_REVOLUTE",
    "CONSTRAINED_JOINT_SPHERICAL",
    "CONSTRAINED_LAGRANGE_IN_SOLID",
    "CONSTRAINED_BEAM_IN_SOLID",
    "CONSTRAINED_NODAL_RIGID_BODY",
    "CONSTRAINED_NODE_SET",
    "CONSTRAINED_RIGID_BODIES",
    "CONSTRAINED_SPOTWELD",
    "CONTACT_2D_AUTOMATIC_SINGLE_SURFACE",
    "CONTACT_ENTITY",
    "CONTACT_TIEBREAK_SURFACE_TO_SURFACE",
    "CONTACT_TIEBREAK_NODES_TO_SURFACE",
    "CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_TIEBREAK",
    "CONTACT_TIED_SURFACE_TO_SURFACE_OFFSET",
    "CONTACT_TIED_NODES_TO_SURFACE_OFFSET",
    "CONTACT_TIED_SHELL_EDGE_TO_SURFACE",
    "CONTROL_ADAPTIVE",
    "CONTROL_COUPLING",
    "CONTROL_DYNAMIC_RELAXATION",
    "CONTROL_EXPLICIT_THERMAL_SOLVER",
    "CONTROL_IMPLICIT_AUTO",
    "CONTROL_IMPLICIT_DYNAMICS",
    "CONTROL_IMPLICIT_EIGENVALUE",
    "CONTROL_IMPLICIT_SOLUTION",
    "CONTROL_IMPLICIT_SOLVER",
    "CONTROL_NONLOCAL",
    "CONTROL_RIGID",
    "CONTROL_SPH",
    "CONTROL_THERMAL_NONLINEAR",
    "CONTROL_THERMAL_SOLVER",
    "CONTROL_THERMAL_TIMESTEP",
    "DAMPING_PART_MASS",
    "DAMPING_PART_STIFFNESS",
    "DAMPING_FREQUENCY_RANGE",
    "DEFINE_COORDINATE_NODES",
    "DEFINE_COORDINATE_VECTOR",
    "DEFINE_CURVE_FUNCTION",
    "DEFINE_CURVE_SMOOTH",
    "DEFINE_FRICTION",
    "DEFINE_FUNCTION",
    "DEFINE_SD_ORIENTATION",
    "DEFINE_TABLE_3D",
    "DEFORMABLE_TO_RIGID",
    "DEFORMABLE_TO_RIGID_AUTOMATIC",
    "ELEMENT_BEAM",
    "ELEMENT_DISCRETE",
    "ELEMENT_INERTIA",
    "ELEMENT_MASS_PART",
    "ELEMENT_SEATBELT",
    "ELEMENT_SHELL",
    "ELEMENT_SHELL_THICKNESS",
    "ELEMENT_SOLID_ORTHO",
    "ELEMENT_SPH",
    "ELEMENT_TSHELL",
    "INITIAL_FOAM_REFERENCE_GEOMETRY",
    "INITIAL_STRAIN_SOLID",
    "INITIAL_STRESS_SOLID",
    "INITIAL_STRESS_SHELL",
    "INITIAL_TEMPERATURE_NODE",
    "INITIAL_TEMPERATURE_SET",
    "INITIAL_VOLUME_FRACTION_GEOMETRY",
    "INITIAL_VOID_PART",
    "INTEGRATION_BEAM",
    "INTEGRATION_SHELL",
    "LOAD_BLAST_SEGMENT",
    "LOAD_BLAST_SEGMENT_SET",
    "LOAD_BODY_PARTS",
    "LOAD_BODY_RX",
    "LOAD_BODY_RY",
    "LOAD_BODY_RZ",
    "LOAD_RIGID_BODY",
    "LOAD_SHELL_SET",
    "LOAD_THERMAL_LOAD_CURVE",
    "MAT_ADD_DAMAGE_GISSMO",
    "MAT_ADD_THERMAL_EXPANSION",
    "MAT_ELASTIC_PLASTIC_THERMAL",
    "MAT_THERMAL_ISOTROPIC",
    "MAT_SPRING_ELASTIC",
    "MAT_SPOTWELD",
    "MAT_ORTHOTROPIC_ELASTIC",
    "MAT_COMPOSITE_DAMAGE",
    "MAT_OGDEN_RUBBER",
    "MAT_BLATZ-KO_RUBBER",
    "MAT_HYPERELASTIC_RUBBER",
    "MAT_SIMPLIFIED_RUBBER/FOAM",
    "MAT_PLASTICITY_COMPRESSION_TENSION",
    "MAT_MODIFIED_ZERILLI_ARMSTRONG",
    "MAT_JOHNSON_COOK_STOCHASTIC",
    "MAT_JOHNSON_HOLMQUIST_JH1",
    "PARAMETER_DUPLICATION",
    "PARAMETER_TYPE",
    "PART_COMPOSITE",
    "PART_MOVE",
    "PERTURBATION_NODE",
    "RIGIDWALL_PLANAR_FORCES",
    "RIGIDWALL_PLANAR_MOVING_FORCES",
    "RIGIDWALL_GEOMETRIC_CYLINDER",
    "RIGIDWALL_GEOMETRIC_SPHERE",
    "RIGIDWALL_GEOMETRIC_PRISM",
    "SECTION_BEAM",
    "SECTION_DISCRETE",
    "SECTION_SHELL",
    "SECTION_SPH",
    "SECTION_TSHELL",
    "SECTION_SOLID_ALE",
    "SENSOR_CONTROL",
    "SET_BEAM",
    "SET_BOX",
    "SET_DISCRETE",
    "SET_NODE_COLUMN",
    "SET_SHELL",
    "SET_SHELL_LIST",
    "SET_SOLID_ADD",
    "SET_SOLID_GENERAL",
    "SET_TSHELL",
    "SET_SEGMENT_ADD",
    "SET_NODE_INTERSECT",
    "TERMINATION_NODE",
    "TERMINATION_BODY",
    "TERMINATION_CURVE",
    "INCLUDE_AUTO_OFFSET",
    "INCLUDE_BINARY",
    "INCLUDE_STAMPED_PART",
    "INCLUDE_TRANSFORM_BINARY",
    "INCLUDE_TRIM",
    "INCLUDE_NASTRAN",
    "INCLUDE_COMPENSATION",
    "INITIAL_AXIAL_FORCE_BEAM",
    "INITIAL_STRESS_SECTION",
    "INITIAL_MOMENTUM",
    "CONTROL_REMESHING",
    "CONTROL_REFINE",
    "CONTROL_STAGED_CONSTRUCTION",
    "CONTROL_FREQUENCY_DOMAIN",
    "MAT_NONLOCAL",
    "NODE_TRANSFORM",
    "NODE_MERGE_SET",
    "NODE_MERGE_TOLERANCE",
    "NODE_RIGID_SURFACE",
    "NODE_SCALAR",
};

/// First words of keywords about physics that no part of Kerf computes.
constexpr NamePair groups_of_other_physics[] = {
    {"BATTERY", "batteries"},
    {"CESE", "compressible flow"},
    {"DUALCESE", "compressible flow"},
    {"CHEMISTRY", "chemistry"},
    {"EF", "electric charging"},
    {"EM", "electromagnetism"},
    {"FATIGUE", "fatigue"},
    {"FREQUENCY", "frequency domain"},
    {"ICFD", "incompressible flow"},
    {"IGA", "isogeometric analysis"},
    {"ISPG", "incompressible particles"},
    {"LSO", "output of flow solvers"},
    {"MESH", "meshes of flow solvers"},
    {"PARTICLE", "particle methods"},
    {"STOCHASTIC", "stochastic particles"},
    {"RVE", "representative volumes"},
    {"AIRBAG", "airbags"},
    {"ALE", "arbitrary Lagrangian-Eulerian meshes"},
};

/// Options at the end of a keyword that change its cards.
constexpr std::string_view options[] = {"TITLE", "ID", "MPP", "COLLECT"};

template <class Names>
bool holds(const Names& names, std::string_view name) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

std::string_view group_of(std::string_view name) { return name.substr(0, name.find('_')); }

/// Leading zeros taken off the number after "MAT_" or "EOS_".
std::string with_plain_number(const std::string& name) {
  if (name.rfind("MAT_", 0) != 0 && name.rfind("EOS_", 0) != 0) return name;
  std::size_t first = 4;
  while (first + 1 < name.size() && name[first] == '0') ++first;
  return name.substr(0, 4) + name.substr(first);
}

std::string usual_name(const std::string& name) {
  for (const auto& [other, usual] : other_names)
    if (name == other) return std::string(usual);
  const std::string plain = with_plain_number(name);
  for (const auto& [number, usual] : numbers)
    if (plain == number) return std::string(usual);
  return name;
}

bool is_noted(const std::string& name) {
  return holds(noted_names, name) || (name.rfind("DATABASE_", 0) == 0 && keyword_spec(name) == nullptr);
}

KeywordUse use_of(const std::string& name) {
  if (holds(read_names, name)) return KeywordUse::read;
  if (is_noted(name)) return KeywordUse::noted;
  if (keyword_spec(name)) return KeywordUse::tabled;
  return holds(foreign_names, name) ? KeywordUse::foreign : KeywordUse::unknown;
}

/// "CASE_BEGIN" for CASE_BEGIN_12.
std::string without_case_number(const std::string& name) {
  for (const std::string_view stem : {"CASE_BEGIN", "CASE_END"})
    if (name.rfind(std::string(stem) + "_", 0) == 0) return std::string(stem);
  return name;
}

}  // namespace

KeywordName keyword_named(const std::string& written) {
  std::string name = without_case_number(written);
  KeywordName found;
  for (;;) {
    found.base = usual_name(name);
    found.use = use_of(found.base);
    if (found.use != KeywordUse::unknown) break;
    const std::size_t bar = name.rfind('_');
    if (bar == std::string::npos || !holds(options, std::string_view(name).substr(bar + 1))) {
      found.base = without_case_number(written);
      found.options.clear();
      break;
    }
    found.options.push_back(name.substr(bar + 1));
    name.resize(bar);
  }
  if (found.use == KeywordUse::tabled || found.use == KeywordUse::noted) found.spec = keyword_spec(found.base);
  return found;
}

std::string nearest_keyword(const std::string& name) {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const auto& list : {std::vector<std::string_view>(std::begin(read_names), std::end(read_names)),
                             std::vector<std::string_view>(std::begin(noted_names), std::end(noted_names)),
                             std::vector<std::string_view>(std::begin(foreign_names), std::end(foreign_names))})
      names.insert(names.end(), list.begin(), list.end());
    for (const std::string& tabled : tabled_keywords()) names.push_back(tabled);
    std::sort(names.begin(), names.end());
    return names;
  }();
  return nearest_name(name.substr(0, 80), all);
}

std::string physics_of_group(const std::string& name) {
  for (const auto& [group, physics] : groups_of_other_physics)
    if (group_of(name) == group) return std::string(physics);
  return {};
}

}  // namespace kerf::decks
