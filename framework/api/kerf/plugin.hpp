// How a plugin makes itself known: the registrar it is handed, and the macros that define its entry point.
//
// Registration is an explicit call from a table that CMake generates (never a static initialiser, which
// vanishes from static libraries). The same source file serves as an in-tree plugin and as a shared library.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "kerf/manifest.hpp"
#include "kerf/schema.hpp"

namespace kerf {

/// Number of the contract between engine and plugins; raised whenever a header in kerf/ changes meaning.
inline constexpr int interface_version = 11;

/// A registered type: what it declares and how one is made. `parameters` is the address to fill.
struct Made {
  std::unique_ptr<Plugin> plugin;
  void* parameters = nullptr;
};

namespace detail {

template <class T>
concept HasState = requires {
  typename T::State;
};
template <class T>
concept HasReads = requires {
  typename T::Reads;
};
/// Throws std::runtime_error unless describe() declares every member of `Members` (a law's State or Reads) once, in
/// order: what is not declared gets no memory, and what is declared out of order would be swapped.
template <class Members, class Declared>
void expect_all_declared(const Description& d, const char* what, const std::vector<Declared>& declared) {
  const std::string law = d.kind + " " + d.name + " (" + d.origin + "): ";
  for (std::size_t i = 0; i < declared.size(); ++i)
    if (declared[i].index != static_cast<int>(i))
      throw std::runtime_error(law + "describe() declares `" + declared[i].name + "` in place " +
                               std::to_string(i + 1) + ", but it is double number " +
                               std::to_string(declared[i].index + 1) + " of its " + what +
                               "; declare the members in their order, each once");
  const std::size_t room = std::is_empty_v<Members> ? 0 : sizeof(Members);
  if (declared.size() * sizeof(double) != room)
    throw std::runtime_error(law + "its " + what + " takes " + std::to_string(room) +
                             " bytes, but describe() declares " + std::to_string(declared.size()) + " doubles, " +
                             std::to_string(declared.size() * sizeof(double)) +
                             " bytes; make every member a double or a symmetric tensor and declare it");
}

/// Throws std::runtime_error where a law asks for inputs by its member `inputs`, but asked_inputs() does not say so:
/// the rows would be null.
template <class T>
void expect_inputs_asked(const Description& d) {
  if constexpr (requires { T::inputs; })
    if (T().asked_inputs() != T::inputs)
      throw std::runtime_error(d.kind + " " + d.name + " (" + d.origin +
                               "): `inputs` and asked_inputs() differ; override asked_inputs() to return `inputs`");
}

}  // namespace detail

/// Receives registrations. Implemented by the engine's registry.
class Registrar {
 public:
  virtual ~Registrar() = default;
  virtual void add(Description description, Made (*make)()) = 0;

  template <class T>
  void add_type(const char* kind, const char* name, const char* summary, const char* origin) {
    Description d;
    d.kind = kind;
    d.name = name;
    d.summary = summary;
    d.origin = origin;
    Schema<T> schema(d);
    T::describe(schema);
    if constexpr (detail::HasState<T>) detail::expect_all_declared<typename T::State>(d, "State", d.state);
    if constexpr (detail::HasReads<T>) detail::expect_all_declared<typename T::Reads>(d, "Reads", d.reads);
    detail::expect_inputs_asked<T>(d);
    for (const StateVariable& v : d.state)
      if (v.begins_tensor && (d.kind == "eos" || d.kind == "element"))
        throw std::runtime_error(d.kind + " " + d.name + " (" + d.origin + "): the state variable `" + v.name +
                                 "` belongs to a tensor, which nobody rotates for this kind; declare scalars");
    add(
        std::move(d), +[] {
          auto object = std::make_unique<T>();
          void* address = static_cast<T*>(object.get());
          return Made{std::move(object), address};
        });
  }
};

}  // namespace kerf

KERF_SIZES(plugin, KERF_SIZE(Made), KERF_SIZE(Registrar))

// A shared plugin exports its manifest and its registration under fixed names; in-tree plugins are called
// by a name made from the file, which kerf_add_plugin() passes as KERF_PLUGIN_ENTRY.
#ifdef KERF_PLUGIN_SHARED
#define KERF_MANIFEST_TEXT kerf::detail::manifest_text<struct KerfPluginOfThisFile, kerf::interface_version>()
#define KERF_REGISTER(...)                                                                                    \
  extern "C" {                                                                                                \
  extern __attribute__((visibility("default"))) const decltype(KERF_MANIFEST_TEXT) kerf_plugin_manifest_text; \
  constinit const decltype(KERF_MANIFEST_TEXT) kerf_plugin_manifest_text = KERF_MANIFEST_TEXT;                \
  }                                                                                                           \
  extern "C" __attribute__((visibility("default"))) void kerf_plugin_register(kerf::Registrar& registrar) {   \
    __VA_ARGS__                                                                                               \
  }
#else
#ifndef KERF_PLUGIN_ENTRY
#define KERF_PLUGIN_ENTRY kerf_plugin_register_unnamed
#endif
#define KERF_REGISTER(...)                            \
  void KERF_PLUGIN_ENTRY(kerf::Registrar& registrar); \
  void KERF_PLUGIN_ENTRY(kerf::Registrar& registrar) { __VA_ARGS__ }
#endif

/// One line inside KERF_REGISTER(...); a file may register several types.
#define KERF_TYPE(Type, kind, name, summary) registrar.add_type<Type>(kind, name, summary, __FILE__);

// The kind's base class is declared by its header, so a macro of another kind does not compile.
#define KERF_OF_KIND(Base, Type, kind, name, summary)                 \
  static_assert(std::is_base_of_v<kerf::Base, Type>,                  \
                "the macro is that of another kind: expected a type " \
                "that derives from kerf::" #Base);                    \
  KERF_REGISTER(KERF_TYPE(Type, kind, name, summary))
#define KERF_MATERIAL(Type, name, summary) KERF_OF_KIND(Material, Type, "material", name, summary)
#define KERF_SOLID(Type, name, summary) KERF_OF_KIND(Solid, Type, "solid", name, summary)
#define KERF_EOS(Type, name, summary) KERF_OF_KIND(Eos, Type, "eos", name, summary)
#define KERF_EROSION(Type, name, summary) KERF_OF_KIND(ErosionCriterion, Type, "erosion", name, summary)
#define KERF_CONTACT(Type, name, summary) KERF_OF_KIND(Contact, Type, "contact", name, summary)
#define KERF_ELEMENT(Type, name, summary) KERF_OF_KIND(Element, Type, "element", name, summary)
#define KERF_PARTITIONER(Type, name, summary) KERF_OF_KIND(Partitioner, Type, "partitioner", name, summary)
#define KERF_BALANCE_POLICY(Type, name, summary) KERF_OF_KIND(BalancePolicy, Type, "balance_policy", name, summary)
#define KERF_MEASURE(Type, name, summary) KERF_OF_KIND(Measure, Type, "measure", name, summary)
#define KERF_BOUNDARY(Type, name, summary) KERF_OF_KIND(Boundary, Type, "boundary", name, summary)
#define KERF_MESH(Type, name, summary) KERF_OF_KIND(MeshGenerator, Type, "mesh", name, summary)
#define KERF_LOAD(Type, name, summary) KERF_OF_KIND(Load, Type, "load", name, summary)
#define KERF_OBSERVER(Type, name, summary) KERF_OF_KIND(Observer, Type, "observer", name, summary)
