# Springtide with its kernels compiled. Alone: docker build -t lab .
# As the single-user image of a JupyterHub: docker build -t lab-hub --target hub .
# PROCESSOR: x86-64-v3, x86-64-v4 or arm64, which the building machine has to have. See docs/class.md.

FROM jupyterhub/singleuser:5 AS hub
ARG PROCESSOR=x86-64-v3
USER root
COPY pyproject.toml README.md LICENSE /src/
COPY app /src/app
COPY assets /src/assets
COPY sim /src/sim
RUN pip install --no-cache-dir "/src[jupyter]" && springtide warmup --into --processor "$PROCESSOR"
USER ${NB_USER}

FROM python:3.12-slim AS alone
ARG PROCESSOR=x86-64-v3
COPY pyproject.toml README.md LICENSE /src/
COPY app /src/app
COPY assets /src/assets
COPY sim /src/sim
RUN pip install --no-cache-dir /src && springtide warmup --into --processor "$PROCESSOR"
RUN useradd --create-home student
USER student
EXPOSE 8080
CMD ["springtide", "--no-open", "--host", "0.0.0.0", "--resume"]
