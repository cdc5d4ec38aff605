# Installs the library, its public headers, the program and the scenes. Other projects then use find_package(skerry).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(skerry_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/skerry)
# Headers of components/ that public headers include.
set(skerry_public_components
    types.h options.h handle.h joint_kind.h tie_kind.h spring_side.h cable_control.h cavity_law.h load_kind.h time_key.h
    orthotropic_moduli.h column.h row_memory.h range.h access_check.h)

foreach(type IN ITEMS static shared)
    install(TARGETS skerry_${type} EXPORT skerry_${type}_targets)
    target_include_directories(skerry_${type} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    install(EXPORT skerry_${type}_targets NAMESPACE skerry:: FILE skerry_${type}.cmake
            DESTINATION ${skerry_package_dir})
endforeach()
if(SKERRY_MPI)
    install(TARGETS skerry_mpi EXPORT skerry_mpi_targets)
    install(EXPORT skerry_mpi_targets NAMESPACE skerry:: FILE skerry_mpi.cmake DESTINATION ${skerry_package_dir})
endif()
install(DIRECTORY engine/include/skerry DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)
list(TRANSFORM skerry_public_components PREPEND components/ OUTPUT_VARIABLE skerry_component_headers)
install(FILES ${skerry_component_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/skerry/components)
# Installed headers include "skerry/components/x.h", because a host project may have its own folder `components`.
install(CODE "
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/skerry\")
    file(GLOB headers \"\${folder}/*.h\" \"\${folder}/components/*.h\")
    foreach(header IN LISTS headers)
        file(READ \"\${header}\" text)
        string(REPLACE \"#include \\\"components/\" \"#include \\\"skerry/components/\" text \"\${text}\")
        file(WRITE \"\${header}\" \"\${text}\")
    endforeach()")

# Programs that link the static library also link its packages; the shared library links them itself.
set(SKERRY_LINK_PACKAGES Threads)
foreach(package IN ITEMS HDF5 ZLIB TBB OpenMP)
    if("${skerry_used}" MATCHES "(^|;)${package}::")
        list(APPEND SKERRY_LINK_PACKAGES ${package})
    endif()
endforeach()
set(SKERRY_COMPONENTS static shared)
foreach(part IN ITEMS HDF5 SCENES PAGES LIVE MPI)
    if(SKERRY_${part})
        string(TOLOWER ${part} part)
        list(APPEND SKERRY_COMPONENTS ${part})
    endif()
endforeach()
list(JOIN SKERRY_COMPONENTS "|" SKERRY_COMPONENT_CHOICE)
list(JOIN SKERRY_COMPONENTS ", " SKERRY_COMPONENTS)
configure_package_config_file(cmake/skerryConfig.cmake.in skerryConfig.cmake INSTALL_DESTINATION ${skerry_package_dir})
write_basic_package_version_file(skerryConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/skerryConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/skerryConfigVersion.cmake
        DESTINATION ${skerry_package_dir})


# For pkg-config. A static link needs the libraries of the packages, by file name if there is no option -l for them.
set(SKERRY_PC_PRIVATE "-lstdc++ -lm ${CMAKE_THREAD_LIBS_INIT}")
foreach(library IN LISTS skerry_used)
    if(library STREQUAL "HDF5::HDF5")
        list(JOIN HDF5_C_LIBRARIES " " files)
        string(APPEND SKERRY_PC_PRIVATE " ${files}")
    elseif(library STREQUAL "ZLIB::ZLIB")
        string(APPEND SKERRY_PC_PRIVATE " -lz")
    elseif(library STREQUAL "${CIVETWEB_LIBRARY}")
        string(APPEND SKERRY_PC_PRIVATE " ${CIVETWEB_LIBRARY}")
    elseif(library STREQUAL "TBB::tbb")
        string(APPEND SKERRY_PC_PRIVATE " -ltbb")
    elseif(library STREQUAL "OpenMP::OpenMP_CXX")
        list(JOIN OpenMP_CXX_LIBRARIES " " files)
        string(APPEND SKERRY_PC_PRIVATE " ${files}")
    endif()
endforeach()
# Paths relative to this file allow an installation to be moved.
file(RELATIVE_PATH skerry_prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/skerry.pc.in skerry.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/skerry.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/skerry)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET skerry_program)
    install(TARGETS skerry_program)
    if(TARGET skerry_netgen)
        install(TARGETS skerry_netgen)
    endif()
endif()
