# docker build -t landscape . && docker run -v "$PWD/out:/artifact/build" landscape figures

# The first stage has the compilers that Kwant and the core need, and makes .venv just as outside a
# container.
FROM python:3.11-slim-bookworm AS build
RUN apt-get update \
 && apt-get install -y --no-install-recommends g++ gcc libc6-dev make \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /artifact
COPY Makefile CMakeLists.txt pyproject.toml requirements*.lock LICENSE ./
COPY scripts scripts
COPY core core
# The Python sources come later, so that a change in them does not build Kwant again; until then, the
# two packages that an editable install is told of are empty.  Bytecode is written now, because the
# user of the second stage cannot write into .venv.
RUN mkdir -p src/disorder_landscape/solver \
 && touch README.md src/disorder_landscape/__init__.py src/disorder_landscape/solver/__init__.py \
 && UV_COMPILE_BYTECODE=1 make setup

FROM python:3.11-slim-bookworm
RUN apt-get update \
 && apt-get install -y --no-install-recommends make \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --uid 1000 landscape
WORKDIR /artifact
COPY --from=build /artifact/.venv .venv
COPY . .
# For any user that `docker run --user` names; scripts/container.mk says how root is left.
RUN cp scripts/container.mk GNUmakefile && mkdir --mode=1777 build
# All caches (Matplotlib, Keras, pytest, …) go where that user can write.
ENV HOME=/artifact/build/.cache \
    XDG_CACHE_HOME=/artifact/build/.cache \
    MPLCONFIGDIR=/artifact/build/.cache/matplotlib \
    HYPOTHESIS_STORAGE_DIRECTORY=/artifact/build/.cache/hypothesis \
    PYTEST_ADDOPTS="-o cache_dir=/artifact/build/.cache/pytest" \
    RUFF_CACHE_DIR=/artifact/build/.cache/ruff \
    MYPY_CACHE_DIR=/artifact/build/.cache/mypy \
    MPLBACKEND=Agg \
    OMP_NUM_THREADS=1 \
    OPENBLAS_NUM_THREADS=1 \
    MKL_NUM_THREADS=1
ENTRYPOINT ["make"]
CMD ["help"]
