# Writes OUTPUT, a C++ file that defines the strings of page_assets.h. Run by the build with -D OUTPUT, SOURCE_DIR,
# THREE_JS, SCRIPTS.
function(embed name)
    set(text "")
    foreach(file IN LISTS ARGN)
        file(READ ${file} part)
        string(APPEND text "${part}")
    endforeach()
    file(APPEND ${OUTPUT}.part "const std::string_view ${name} = R\"skerry_asset(${text})skerry_asset\";\n")
endfunction()

# embed_packed(NAME FILE): the text of a file in the gzip format, as bytes. FILE may be empty.
function(embed_packed name file)
    set(bytes "")
    if(file)
        file(ARCHIVE_CREATE OUTPUT ${OUTPUT}.gz PATHS ${file} FORMAT raw COMPRESSION GZip COMPRESSION_LEVEL 9)
        file(READ ${OUTPUT}.gz bytes HEX)
        file(REMOVE ${OUTPUT}.gz)
        # The header without the time of the compression, which would make every build different (RFC 1952).
        string(SUBSTRING "${bytes}" 16 -1 rest)
        set(bytes "1f8b080000000000${rest}")
        string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
        string(LENGTH "${bytes}" length)
        math(EXPR length "${length} / 4")
    else()
        set(length 0)
    endif()
    file(APPEND ${OUTPUT}.part "const std::string_view ${name}{\"${bytes}\", ${length}};\n")
endfunction()

file(WRITE ${OUTPUT}.part "// Written by embed.cmake.\n"
                          "#include \"engine/output/page/page_assets.h\"\n\nnamespace skerry {\n")
embed(page_html ${SOURCE_DIR}/page.html)
embed(page_style ${SOURCE_DIR}/page.css)
list(TRANSFORM SCRIPTS PREPEND ${SOURCE_DIR}/)
embed(page_script ${SCRIPTS})
embed_packed(three_js "${THREE_JS}")
file(APPEND ${OUTPUT}.part "}  // namespace skerry\n")
file(RENAME ${OUTPUT}.part ${OUTPUT})
