# Installs the API headers and the package `Kerf`, and writes the same package into the build tree, so that a
# plugin author may use either: cmake -DKerf_DIR=<kerf>/build or -DCMAKE_PREFIX_PATH=<prefix>.
include(CMakePackageConfigHelpers)

set(KERF_PLUGIN_COMPILE_OPTIONS "${KERF_COMPILE_OPTIONS}")
list(FILTER KERF_PLUGIN_COMPILE_OPTIONS EXCLUDE REGEX "Werror")

install(DIRECTORY framework/api/kerf DESTINATION include FILES_MATCHING PATTERN "*.hpp")
install(TARGETS kerf_api EXPORT KerfTargets)
install(EXPORT KerfTargets NAMESPACE Kerf:: DESTINATION lib/cmake/Kerf)
export(EXPORT KerfTargets NAMESPACE Kerf:: FILE "${PROJECT_BINARY_DIR}/KerfTargets.cmake")

configure_package_config_file(framework/cmake/KerfConfig.cmake.in "${PROJECT_BINARY_DIR}/KerfConfig.cmake"
                              INSTALL_DESTINATION lib/cmake/Kerf NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/KerfConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
configure_file(framework/cmake/kerf_add_plugin.cmake "${PROJECT_BINARY_DIR}/kerf_add_plugin.cmake" COPYONLY)
install(FILES "${PROJECT_BINARY_DIR}/KerfConfig.cmake" "${PROJECT_BINARY_DIR}/KerfConfigVersion.cmake"
              "${PROJECT_BINARY_DIR}/kerf_add_plugin.cmake"
        DESTINATION lib/cmake/Kerf)
