# need_packages USE: installs the missing packages of scripts/lib/packages.txt. Prints nothing if none is missing.

# Prints lines "package reason" for all packages that USE needs.
packages_for() {
    local wanted=" $1 " package use reason
    case $1 in
        test | wheel | profiling | fuzz | site) wanted=" demo $1 " ;;
        ci) wanted=" demo test ci " ;;
    esac
    while read -r package use reason; do
        [[ -z $package || $package == \#* ]] && continue
        if [[ $wanted == *" $use "* ]]; then echo "$package $reason"; fi
    done <"$root/scripts/lib/packages.txt"
}

is_installed() {
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

need_packages() {
    if [[ ${SKERRY_PACKAGES:-} == present ]]; then return; fi
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        {
            echo "This system has no apt. Please install what these Debian packages hold, then run this again with" \
                "SKERRY_PACKAGES=present:"
            packages_for "$1" | sed 's/^\([^ ]*\) /    \1: /'
        } >&2
        exit 3
    fi

    local package reason missing=() why=()
    while read -r package reason; do
        if is_installed "$package"; then continue; fi
        missing+=("$package")
        why+=("$package ($reason)")
    done < <(packages_for "$1")
    if [[ ${#missing[@]} -eq 0 ]]; then return; fi

    local as_root=()
    if [[ $(id -u) -ne 0 ]]; then
        if ! command -v sudo >/dev/null; then
            fail "Missing, and there is no sudo to install it: as root, run: apt-get install ${missing[*]}"
        fi
        as_root=(sudo)
    fi
    local list
    printf -v list '%s, ' "${why[@]}"
    echo "Installing with ${as_root[*]:+${as_root[*]} }apt-get: ${list%, }."
    phase packages install_packages "${missing[@]}"
}

# Only need_packages calls this function, after it has set `as_root`.
install_packages() {
    # If one source of packages is down, the others, or packages known already, may suffice.
    "${as_root[@]}" apt-get update || echo "apt-get update failed; going on with the lists that are there"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}
