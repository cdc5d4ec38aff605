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

file(WRITE ${OUTPUT}.part "// Written by embed.cmake.\n"
                          "#include \"engine/output/page/page_assets.h\"\n\nnamespace skerry {\n")
embed(page_html ${SOURCE_DIR}/page.html)
embed(page_style ${SOURCE_DIR}/page.css)
list(TRANSFORM SCRIPTS PREPEND ${SOURCE_DIR}/)
embed(page_script ${SCRIPTS})
embed(three_js ${THREE_JS})
file(APPEND ${OUTPUT}.part "}  // namespace skerry\n")
file(RENAME ${OUTPUT}.part ${OUTPUT})
