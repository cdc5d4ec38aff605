# Installs the build folder BUILD below WORK. Links the program HOST, which uses Eigen itself, in all ways of
# docs/linking.md, with the compilers COMPILERS and other flags than Skerry. Each program must end with the same state
# as PROGRAM.
function(run out)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE errors
                    WORKING_DIRECTORY ${WORK})
    if(NOT status EQUAL 0)
        list(JOIN ARGN " " command)
        message(FATAL_ERROR "${command}: ${status}\n${text}\n${errors}")
    endif()
    string(STRIP "${text}" text)
    set(${out} "${text}" PARENT_SCOPE)
endfunction()

# A quarter of a second is 2^-2 s, so it has no rounding error as the sum of 16 frames.
set(scene ${SCENES}/skittles.json)
set(frame_step 0.015625)
set(frames 16)
set(seconds 0.25)

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
run(ignored ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(ignored ${PROGRAM} run ${scene} --seconds ${seconds} --set frame_step=${frame_step} --quiet --stats stats.json)
file(READ ${WORK}/stats.json stats)
string(JSON expected GET "${stats}" state_hash)

function(check_host name host)
    run(found ${CMAKE_COMMAND} -E env --unset=SKERRY_INSTRUCTION_SET LD_LIBRARY_PATH=${libraries}
        ${host} ${scene} ${frame_step} ${frames})
    if(NOT found STREQUAL expected)
        message(FATAL_ERROR "${name}: the state is ${found}, of the program ${expected}")
    endif()
    message(STATUS "${name}: ${found}")
endfunction()

file(GLOB archive ${WORK}/prefix/lib*/libskerry.a ${WORK}/prefix/lib/*/libskerry.a)
cmake_path(GET archive PARENT_PATH libraries)
set(ENV{PKG_CONFIG_PATH} ${libraries}/pkgconfig)
set(flags_0 -O0)
set(flags_1 -O2 -mavx)  # Eigen then aligns to 32 bytes
set(number 0)
foreach(compiler IN LISTS COMPILERS)
    math(EXPR which "${number} % 2")
    list(JOIN flags_${which} " " flags)
    foreach(type IN ITEMS static shared)
        set(folder ${WORK}/${number}_${type})
        run(ignored ${CMAKE_COMMAND} -S ${HOST} -B ${folder} -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${compiler}
            "-DCMAKE_CXX_FLAGS=${flags}" -D CMAKE_BUILD_TYPE= -D CMAKE_PREFIX_PATH=${WORK}/prefix -D TYPE=${type})
        run(ignored ${CMAKE_COMMAND} --build ${folder})
        check_host("${compiler} ${flags}, CMake, ${type}" ${folder}/host)
        if(PKG_CONFIG)
            if(type STREQUAL "static")
                run(options ${PKG_CONFIG} --cflags --libs --static skerry)
                string(REPLACE "-lskerry" "-l:libskerry.a" options "${options}")
            else()
                run(options ${PKG_CONFIG} --cflags --libs skerry)
            endif()
            separate_arguments(options UNIX_COMMAND "${options}")
            run(ignored ${compiler} -std=c++20 ${flags_${which}} ${HOST}/host.cpp ${HOST}/own_systems.cpp
                -o ${folder}/packaged ${options})
            check_host("${compiler} ${flags}, pkg-config, ${type}" ${folder}/packaged)
        endif()
    endforeach()
    math(EXPR number "${number} + 1")
endforeach()
