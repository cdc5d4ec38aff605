# Installs the library, its public headers, the program and the scenes, so that find_package(skerry) works from
# elsewhere.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(skerry_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/skerry)
# What public headers include of components/.
set(skerry_public_components types.h options.h handle.h column.h access_check.h)

install(TARGETS skerry EXPORT skerryTargets)
target_include_directories(skerry INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
install(DIRECTORY engine/include/skerry DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)
list(TRANSFORM skerry_public_components PREPEND components/ OUTPUT_VARIABLE skerry_component_headers)
install(FILES ${skerry_component_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/skerry/components)
# "components/x.h" would be found by the wrong name in a project that has a components folder of its own: installed
# headers say "skerry/components/x.h".
install(CODE "
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/skerry\")
    file(GLOB headers \"\${folder}/*.h\" \"\${folder}/components/*.h\")
    foreach(header IN LISTS headers)
        file(READ \"\${header}\" text)
        string(REPLACE \"#include \\\"components/\" \"#include \\\"skerry/components/\" text \"\${text}\")
        file(WRITE \"\${header}\" \"\${text}\")
    endforeach()")

# A static library leaves its packages to whoever links it; a shared one has them inside.
get_target_property(skerry_type skerry TYPE)
set(SKERRY_LINK_PACKAGES "")
if(skerry_type STREQUAL "STATIC_LIBRARY")
    set(SKERRY_LINK_PACKAGES Threads HDF5 ZLIB)
    if("tbb" IN_LIST SKERRY_BACKENDS)
        list(APPEND SKERRY_LINK_PACKAGES TBB)
    endif()
    if("openmp" IN_LIST SKERRY_BACKENDS)
        list(APPEND SKERRY_LINK_PACKAGES OpenMP)
    endif()
endif()
configure_package_config_file(cmake/skerryConfig.cmake.in skerryConfig.cmake INSTALL_DESTINATION ${skerry_package_dir})
write_basic_package_version_file(skerryConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT skerryTargets NAMESPACE skerry:: DESTINATION ${skerry_package_dir})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/skerryConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/skerryConfigVersion.cmake
        DESTINATION ${skerry_package_dir})

install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/skerry)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET skerry_program)
    install(TARGETS skerry_program)
    if(TARGET skerry_fill)
        install(TARGETS skerry_fill)
    endif()
endif()
