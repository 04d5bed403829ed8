# What `cmake --install` puts where. Every library has an export set of its own, so that a project which wants
# only Loden::material never looks for Embree.
include(CMakePackageConfigHelpers)
set(LODEN_CONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Loden)

# Installs target loden_<component> as Loden::<component>, with its public headers below include/loden/.
# loden_install_library(COMPONENT HEADERS ...), called in the library's own folder.
function(loden_install_library component)
  cmake_parse_arguments(arg "" "" "HEADERS" ${ARGN})
  # Before 1.0 every minor version may break its users' binaries.
  set_target_properties(loden_${component} PROPERTIES VERSION ${PROJECT_VERSION}
          SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_sources(loden_${component} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES
          ${arg_HEADERS})
  install(TARGETS loden_${component} EXPORT Loden-${component}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/loden)
  install(EXPORT Loden-${component} NAMESPACE Loden:: DESTINATION ${LODEN_CONFIG_DIR}
          FILE Loden-${component}-targets.cmake)
endfunction()

# The package's entry files; called once.
function(loden_install_package)
  configure_package_config_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/LodenConfig.cmake.in
                                ${PROJECT_BINARY_DIR}/LodenConfig.cmake
                                INSTALL_DESTINATION ${LODEN_CONFIG_DIR}
                                PATH_VARS CMAKE_INSTALL_DATADIR)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/LodenConfigVersion.cmake COMPATIBILITY
          SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/LodenConfig.cmake ${PROJECT_BINARY_DIR}/LodenConfigVersion.cmake
                ${PROJECT_SOURCE_DIR}/importer/cmake/FindOpenSubdiv.cmake
          DESTINATION ${LODEN_CONFIG_DIR})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md
          ${PROJECT_SOURCE_DIR}/CHANGELOG.md
          DESTINATION ${CMAKE_INSTALL_DOCDIR})
  # Where README.md's links lead.
  foreach(page importer/README.md runtime/EMBEDDING.md sample_game/README.md material/FORMAT.md
          importer/gltf/README.md)
    get_filename_component(folder ${page} DIRECTORY)
    install(FILES ${PROJECT_SOURCE_DIR}/${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
  endforeach()
endfunction()
