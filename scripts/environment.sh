# Sourced by the scripts beside it: `prepare EXTRA` makes the project's .venv where it is missing and
# installs `.[EXTRA]` there, again only when pyproject.toml, constraints.txt or the place of the project changed.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
venv=$root/.venv

say() { printf '%s\n' "$*" >&2; }

fail() {
    say "$(basename "$0"): $*"
    exit 2
}

find_python() {
    local candidate
    for candidate in "${DEM_PYTHON:-}" python3.11 python3.12 python3.13 python3 python; do
        [ -n "$candidate" ] || continue
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then
            "$candidate" -c 'import ensurepip, venv' >/dev/null 2>&1 && printf '%s' "$candidate" && return
            without_venv=$candidate
        fi
    done
    [ -z "${without_venv:-}" ] || fail "$without_venv has no venv module; on Debian or Ubuntu install python3-venv"
    fail "needs Python 3.11 or newer with venv, found: $(python3 --version 2>&1 | tail -n 1)" \
        "(set DEM_PYTHON to use a certain interpreter)"
}

prepare() {
    local extra=$1 wanted python
    wanted="$root $(cat "$root/pyproject.toml" "$root/constraints.txt" | cksum)"
    if [ -x "$venv/bin/dem" ] && "$venv/bin/python" -c '' 2>/dev/null; then
        local stamp
        for stamp in "$venv/.installed-$extra" "$venv/.installed-dev"; do  # dev holds everything
            [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$wanted" ] && return
        done
    fi
    if ! "$venv/bin/python" -m pip --version >/dev/null 2>&1; then
        python=$(find_python) || exit 2
        say "making the environment $venv"
        "$python" -m venv --clear "$venv" || fail "could not make $venv"
    fi
    say "installing dem and what it needs (once, about a minute)"
    # pip compiles every module to bytecode, a long while; Python compiles and keeps those that a run imports.
    local bytecode=--compile
    [ "$extra" = dev ] || [ -n "${PYTHONDONTWRITEBYTECODE:-}" ] || bytecode=--no-compile
    rm -f "$venv"/.installed-*
    if ! "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-warn-script-location \
        "$bytecode" --constraint "$root/constraints.txt" --editable "$root[$extra]" >"$venv/install.log" 2>&1; then
        tail -n 15 "$venv/install.log" >&2
        fail "the installation failed; the whole output is in $venv/install.log"
    fi
    printf '%s\n' "$wanted" >"$venv/.installed-$extra"
}
