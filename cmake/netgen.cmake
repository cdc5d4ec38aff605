# The library of Netgen for the program skerry-fill, which `skerry fill` and `skerry inspect --repair` start. Without it
# these commands name the missing package.
# Debian installs the libraries in a separate folder. libnglib.so also needs libinterface.so.
find_path(NGLIB_INCLUDE nglib.h PATH_SUFFIXES netgen DOC "Folder of nglib.h (Debian: libnglib-dev)")
find_library(NGLIB_LIBRARY nglib PATH_SUFFIXES netgen DOC "Netgen's library with the C interface")
find_library(NGLIB_INTERFACE_LIBRARY interface PATH_SUFFIXES netgen DOC "Part of Netgen that Debian builds apart")
mark_as_advanced(NGLIB_INCLUDE NGLIB_LIBRARY NGLIB_INTERFACE_LIBRARY)
if(NGLIB_INCLUDE AND NGLIB_LIBRARY)
    add_library(skerry_nglib INTERFACE)
    target_include_directories(skerry_nglib SYSTEM INTERFACE ${NGLIB_INCLUDE})
    target_link_libraries(skerry_nglib INTERFACE -Wl,--no-as-needed ${NGLIB_LIBRARY})
    if(NGLIB_INTERFACE_LIBRARY)
        target_link_libraries(skerry_nglib INTERFACE ${NGLIB_INTERFACE_LIBRARY})
    endif()
    target_link_libraries(skerry_nglib INTERFACE -Wl,--as-needed -Wl,--allow-shlib-undefined)
endif()
