# Springtide with its kernels compiled. Alone: docker build -t lab .
# As the image of a JupyterHub, of its version: docker build -t lab-hub --target hub --build-arg HUB=$(jupyterhub --version) .
# The kernels are for each level of processors that the building machine has. See docs/class.md.

FROM quay.io/jupyter/base-notebook AS hub
ARG HUB
USER root
COPY pyproject.toml README.md LICENSE /src/
COPY app /src/app
COPY assets /src/assets
COPY sim /src/sim
RUN pip install --no-cache-dir "jupyterhub${HUB:+==$HUB}" "/src[jupyter]" && springtide warmup --into --processor all
USER ${NB_USER}

FROM python:3.12-slim AS alone
COPY pyproject.toml README.md LICENSE /src/
COPY app /src/app
COPY assets /src/assets
COPY sim /src/sim
RUN pip install --no-cache-dir /src && springtide warmup --into --processor all
RUN useradd --create-home student
USER student
EXPOSE 8080
CMD ["springtide", "--no-open", "--host", "0.0.0.0", "--resume"]
