# skerry_readme_code(README SOURCE): writes the first block of C++ in README as a program: as it is when it has a main,
# else its includes, then the rest as the body of main. Writes nothing, and removes what it wrote before, when there is
# no such block.
function(skerry_readme_code readme source)
    set(text "")
    if(EXISTS ${readme})
        file(READ ${readme} text)
    endif()
    string(FIND "${text}" "```cpp\n" begin)
    if(begin EQUAL -1)
        file(REMOVE ${source})
        return()
    endif()
    math(EXPR begin "${begin} + 7")
    string(SUBSTRING "${text}" ${begin} -1 text)
    string(FIND "${text}" "```" end)
    string(SUBSTRING "${text}" 0 ${end} code)

    if(code MATCHES "int main\\(")
        file(CONFIGURE OUTPUT ${source} @ONLY CONTENT "// From README.md.\n@code@")
        return()
    endif()

    # Lines cannot be told apart as a list: code is full of semicolons.
    set(includes "")
    set(body "\n${code}")
    while(body MATCHES "\n(#include [^\n]*)\n")
        set(line "${CMAKE_MATCH_1}")
        string(APPEND includes "${line}\n")
        string(REPLACE "\n${line}\n" "\n" body "${body}")
    endwhile()
    file(CONFIGURE OUTPUT ${source} @ONLY CONTENT "// From README.md.\n@includes@\nint main() {@body@}\n")
endfunction()
