# three.js is inlined into every page.
if(SKERRY_THREE_JS)
    set(three_js ${SKERRY_THREE_JS})
else()
    set(three_js "")
    message(WARNING "three.min.js not found: PageWriter of this build refuses to write pages. "
                    "Install libjs-three or set SKERRY_THREE_JS.")
endif()

set(page_scripts
    data/page_decode.js
    data/page_colors.js
    data/page_fields.js
    data/page_scales.js
    data/page_measure.js
    view/page_pace.js
    view/page_view.js
    view/page_pointers.js
    view/page_drawing.js
    view/page_bodies.js
    view/page_instances.js
    view/page_contacts.js
    view/page_lines.js
    view/page_colliders.js
    view/page_pick.js
    view/page_labels.js
    panel/page_plots.js
    panel/page_summary.js
    panel/page_legend.js
    panel/page_tip.js
    panel/page_picture.js
    panel/page_video.js
    panel/page_keys.js
    live/page_link.js
    live/page_sliders.js
    live/page_pull.js
    live/page_live.js
    page_scene.js
    page_controls.js
    page_recorded.js
    page_main.js
)
set(page_assets ${CMAKE_CURRENT_BINARY_DIR}/page_assets.cpp)
list(TRANSFORM page_scripts PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/page/player/ OUTPUT_VARIABLE page_script_files)
add_custom_command(OUTPUT ${page_assets}
    COMMAND ${CMAKE_COMMAND} -D OUTPUT=${page_assets} -D SOURCE_DIR=${CMAKE_CURRENT_SOURCE_DIR}/page/player
        -DTHREE_JS=${three_js} "-DSCRIPTS=${page_scripts}" -P ${CMAKE_CURRENT_SOURCE_DIR}/page/embed.cmake
    DEPENDS page/embed.cmake page/player/page.html page/player/page.css ${page_script_files} ${three_js}
    COMMENT "Embedding the page player" VERBATIM)

set(page_streams
    page/stream/body_stream.cpp
    page/stream/contact_stream.cpp
    page/stream/deflate.cpp
    page/stream/line_stream.cpp
    page/stream/pack.cpp
    page/stream/visual_stream.cpp
)
set(pages
    film/write_gltf.cpp
    page/page_data.cpp
    page/page_document.cpp
    page/page_stream.cpp
    page/page_writer.cpp
    ${page_assets}
)
