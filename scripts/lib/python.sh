# Virtual environments for the Python package. Needs common.sh.

requirements=$root/scripts/lib/python_requirements.txt

# make_venv FOLDER PYTHON: makes an empty virtual environment.
make_venv() {
    "$2" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
        fail "$2: found $("$2" --version 2>&1), expected Python 3.11 or later"
    rm -rf "$1"
    "$2" -m venv "$1" || fail "$2 cannot make a virtual environment; Debian: apt-get install python3-venv"
}

# install_python FOLDER ARGUMENT...: pip install in a virtual environment.
install_python() {
    local folder=$1
    shift
    "$folder/bin/python" -m pip install --quiet --disable-pip-version-check --retries 10 --timeout 60 "$@" || fail \
        "pip could not install: $*" $'\n'"It needs PyPI, or a folder of wheels in PIP_FIND_LINKS with PIP_NO_INDEX=1." \
        $'\n'"SKERRY_PYTHON=OFF in the environment leaves out the Python package and its tests."
}

fill_test_venv() {
    make_venv build/venv python3
    install_python build/venv -r "$requirements"
    cp "$requirements" build/venv/requirements.txt
}

# need_python: makes build/venv, again after a change of the requirements, and adds the Python package to
# configure_options.
need_python() {
    if [[ ${SKERRY_PYTHON:-ON} == OFF ]]; then
        echo "SKERRY_PYTHON=OFF: the Python package is not built, and its tests are left out."
        configure_options+=" -DSKERRY_PYTHON=OFF"
        return
    fi
    if ! build/venv/bin/python -c '' 2>/dev/null || ! cmp -s "$requirements" build/venv/requirements.txt; then
        phase python-packages fill_test_venv
    fi
    configure_options+=" -DSKERRY_PYTHON=ON -DPython_EXECUTABLE=$root/build/venv/bin/python"
}
