# Sourced by the scripts beside it: `prepare EXTRA` makes the project's .venv where it is missing and
# installs `.[EXTRA]` there, again only when pyproject.toml, constraints.txt or the place of the project changed.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
venv=$root/.venv

say() { printf '%s\n' "$*" >&2; }

fail() {
    say "$(basename "$0"): $*"
    exit 2
}

# A pip that installs into environments without one, so that they need not be given their own first (four seconds).
new_pip='import venv, pip; raise SystemExit(tuple(map(int, pip.__version__.split(".")[:2])) < (22, 3))'

find_python() {
    local candidate
    for candidate in "${DEM_PYTHON:-}" python3.11 python3.12 python3.13 python3 python; do
        [ -n "$candidate" ] || continue
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then
            "$candidate" -c 'import ensurepip, venv' >/dev/null 2>&1 && printf '%s' "$candidate" && return
            "$candidate" -c "$new_pip" >/dev/null 2>&1 && printf '%s' "$candidate" && return
            without_venv=$candidate
        fi
    done
    [ -z "${without_venv:-}" ] || fail "$without_venv has no venv module; on Debian or Ubuntu install python3-venv"
    fail "needs Python 3.11 or newer with venv, found: $(python3 --version 2>&1 | tail -n 1)" \
        "(set DEM_PYTHON to use a certain interpreter)"
}

make_environment() {
    local python without=()
    python=$(find_python) || exit 2
    ! "$python" -c "$new_pip" >/dev/null 2>&1 || without=(--without-pip)
    say "making the environment $venv"
    "$python" -m venv --clear ${without[@]+"${without[@]}"} "$venv" || fail "could not make $venv"
    pip=("$venv/bin/python" -m pip)
    [ ${#without[@]} = 0 ] || pip=("$python" -m pip --python "$venv/bin/python")
}

# pip reads all that an index has of a package before it takes one file: uv installs for a third of the CPU time. It does
# not know what pip was told of indexes, and then leaves the work to pip, as where it does not come or does not go.
find_uv() {
    [ -z "${PIP_INDEX_URL:-}${PIP_NO_INDEX:-}" ] || return 1
    ! grep -qsE '^ *(index[-_]url|no[-_]index)' "${PIP_CONFIG_FILE:-/dev/null}" /etc/pip.conf /etc/xdg/pip/pip.conf \
        {"${HOME:-}",}/Library/Application\ Support/pip/pip.conf "${HOME:-}/.pip/pip.conf" \
        "${XDG_CONFIG_HOME:-${HOME:-}/.config}/pip/pip.conf" || return 1
    uv=$(command -v uv) && return
    uv=$venv/bin/uv
    [ -x "$uv" ] || "${pip[@]}" install --quiet --disable-pip-version-check --no-compile \
        --constraint "$root/constraints.txt" uv
}

install_with_uv() {
    find_uv || return 1
    "$uv" pip install --quiet --python "$venv/bin/python" ${uv_options[@]+"${uv_options[@]}"} \
        --constraint "$root/constraints.txt" --editable "$root[$1]" pip
}

install_with_pip() {
    "${pip[@]}" install --quiet --disable-pip-version-check --no-warn-script-location "${pip_options[@]}" \
        --constraint "$root/constraints.txt" --editable "$root[$1]" pip
}

prepare() {
    local extra=$1 wanted pip=("$venv/bin/python" -m pip) uv pip_options=(--no-compile) uv_options=()
    wanted="$root $(cat "$root/pyproject.toml" "$root/constraints.txt" | cksum)"
    if [ -x "$venv/bin/dem" ] && "$venv/bin/python" -c '' 2>/dev/null; then
        local stamp
        for stamp in "$venv/.installed-$extra" "$venv/.installed-dev"; do  # dev holds everything
            [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$wanted" ] && return
        done
    fi
    # A package that a kill cut short looks whole to pip and uv, and would stay as it is.
    { [ ! -e "$venv/.installing" ] && "$venv/bin/python" -c 'import pip' >/dev/null 2>&1; } || make_environment
    say "installing dem and what it needs: NumPy, Numba, VTK and more (once, about half a minute)"
    # To compile every module to bytecode takes long; Python compiles and keeps those that a run imports.
    [ "$extra" != dev ] || pip_options=(--compile) uv_options=(--compile-bytecode)
    rm -f "$venv"/.installed-*
    : >"$venv/.installing"
    if ! { install_with_uv "$extra" || install_with_pip "$extra"; } >"$venv/install.log" 2>&1; then
        tail -n 15 "$venv/install.log" >&2
        fail "the installation failed; the whole output is in $venv/install.log"
    fi
    rm -f "$venv/.installing"
    printf '%s\n' "$wanted" >"$venv/.installed-$extra"
    # The first command keeps the bytecode of what it imports, which is part of installing it, whatever later ones do.
    unset PYTHONDONTWRITEBYTECODE
}
