# Reproduce the tables of a study's report from the CSV files of its dataset alone.
#
# Usage: Rscript analysis/tables.R [FOLDER]; the tables go to FOLDER, by default results/ of the dataset.
# It needs nlme, which comes with R. analysis/tables.py does the same in Python. With more than 13 people, or
# more than 20,000 ways to form two groups, the randomisation test draws at random in Python alone: NA here.

suppressPackageStartupMessages(library(nlme))

script <- sub("^--file=", "", grep("^--file=", commandArgs(), value = TRUE))
dataset <- dirname(dirname(normalizePath(script)))
given <- commandArgs(trailingOnly = TRUE)
out <- if (length(given)) given[1] else file.path(dataset, "results")

read <- function(name) {
  path <- list.files(file.path(dataset, "data"), paste0("_description-", name, "_data.csv$"), full.names = TRUE)
  read.csv(path, na.strings = "", check.names = FALSE, stringsAsFactors = FALSE)
}

sd_of <- function(values) if (length(values) > 1) sd(values) else NA
mean_of <- function(values) if (length(values)) mean(values) else NA
spreads <- function(values) length(values) > 1 && sd(values) > 1e-9 * max(abs(values))

# Means over trials, then over tasks, by person and condition; NA where a task has no figure.
cell_means <- function(trials, measure, tasks) {
  rows <- trials[trials$task %in% tasks & !is.na(trials[[measure]]), ]
  cells <- tapply(rows[[measure]], list(rows$person, rows$condition, factor(rows$task, tasks)), mean)
  apply(cells, c(1, 2), mean)
}

# Each person's mean over some conditions; NA where one of them has no figure.
side_means <- function(trials, measure, conditions, tasks) {
  means <- cell_means(trials, measure, tasks)
  if (!all(conditions %in% colnames(means))) return(means[, 0] [0])
  rowMeans(means[, conditions, drop = FALSE])
}

results_table <- function(trials, measures) {
  rows <- list()
  for (task in unique(trials$task)) for (condition in unique(trials$condition)) for (measure in measures) {
    means <- side_means(trials, measure, condition, task)
    means <- means[!is.na(means)]
    if (length(means)) {
      rows[[length(rows) + 1]] <- data.frame(
        task = task, condition = condition, measure = measure, n = length(means), mean = mean(means),
        sd = sd_of(means)
      )
    }
  }
  do.call(rbind, rows)
}

# The scales by condition, with Cronbach's alpha and its interval (Feldt 1965); and people's scores.
scores_of <- function(answers) {
  answers$turned <- ifelse(answers$reversed == 1, answers$points + 1 - answers$answer, answers$answer)
  rows <- list()
  scores <- list()
  for (scale in unique(answers$scale)) {
    items <- unique(answers$item[answers$scale == scale])
    for (condition in unique(answers$condition)) {
      given <- answers[answers$scale == scale & answers$condition == condition, ]
      if (!nrow(given)) next
      table <- tapply(given$turned, list(given$person, factor(given$item, items)), mean)
      table <- table[stats::complete.cases(table), , drop = FALSE]
      score <- rowMeans(table)
      n <- nrow(table)
      k <- ncol(table)
      alpha <- low <- high <- NA
      if (n > 1 && k > 1 && var(rowSums(table)) > 0) {
        alpha <- k / (k - 1) * (1 - sum(apply(table, 2, var)) / var(rowSums(table)))
        ends <- 1 - (1 - alpha) * qf(c(0.975, 0.025), n - 1, (n - 1) * (k - 1))
        low <- ends[1]
        high <- ends[2]
      }
      rows[[length(rows) + 1]] <- data.frame(
        scale = scale, condition = condition, n = n, mean = mean_of(score), sd = sd_of(score), alpha = alpha,
        alpha_low = low, alpha_high = high
      )
      if (n) {
        scores[[length(scores) + 1]] <- data.frame(
          person = as.integer(names(score)), condition = condition, scale = scale, score = score
        )
      }
    }
  }
  list(table = do.call(rbind, rows), scores = do.call(rbind, scores))
}

# People who chose each option by condition, and people who answered the question.
options_of <- function(options) {
  by <- options[c("option", "condition", "item")]
  found <- aggregate(cbind(n = rep(1, nrow(options)), chosen = options$chosen), by, sum)
  found[c("item", "condition", "option", "n", "chosen")]
}

# People's means on both sides; within people those of the same people.
two_sides <- function(trials, claim, subject, against, tasks) {
  if (claim$design == "within") {
    one <- side_means(trials, claim$measure, subject, tasks)
    other <- side_means(trials, claim$measure, against, tasks)
    both <- intersect(names(one)[!is.na(one)], names(other)[!is.na(other)])
    return(list(one[both], other[both]))
  }
  means <- cell_means(trials, claim$measure, tasks)
  lapply(list(subject, against), function(side) {
    found <- as.vector(means[, colnames(means) %in% side])
    found[!is.na(found)]
  })
}

# The end of the interval of an effect size, from the noncentral t distribution.
noncentral <- function(t, dof, tail) {
  uniroot(function(ncp) pt(t, dof, ncp) - tail, t + c(-1, 1) * (10 + abs(t)), extendInt = "downX", tol = 1e-12)$root
}

# The t-test of a claim, and its effect size.
tested <- function(claim, one, other) {
  if (claim$design == "within") {
    values <- one - other
    if (!spreads(values)) return(list())
    n <- length(values)
    found <- t.test(values)
    difference <- mean(values)
    dof <- size <- n - 1
    d <- difference / sd(values)
    root <- sqrt(n)
  } else {
    n <- length(one)
    m <- length(other)
    if (min(n, m) < 2 || !(spreads(one) || spreads(other))) return(list())
    found <- t.test(one, other)
    difference <- mean(one) - mean(other)
    dof <- unname(found$parameter)
    size <- n + m - 2
    d <- difference / sqrt(((n - 1) * var(one) + (m - 1) * var(other)) / size)
    root <- sqrt(n * m / (n + m))
  }
  p <- found$p.value
  if (claim$direction == "equal") p <- pt((abs(difference) - claim$margin) / found$stderr, dof)
  correction <- if (size > 1) exp(lgamma(size / 2) - lgamma((size - 1) / 2)) / sqrt(size / 2) else NA
  list(
    difference = difference, low = found$conf.int[1], high = found$conf.int[2], t = unname(found$statistic),
    dof = dof, p = p, d = d, g = d * correction, d_low = noncentral(d * root, size, 0.975) / root,
    d_high = noncentral(d * root, size, 0.025) / root
  )
}

# All trials that a claim compares: value, label, person, and what is held fixed.
compared <- function(trials, claim, subject, against, tasks) {
  rows <- trials[
    trials$condition %in% c(subject, against) & trials$task %in% tasks & !is.na(trials[[claim$measure]]),
  ]
  if (claim$design == "within") {
    both <- intersect(rows$person[rows$condition %in% subject], rows$person[rows$condition %in% against])
    rows <- rows[rows$person %in% both, ]
  }
  fixed <- cbind(rows$order, rows$trial, outer(rows$task, tasks[-1], "=="))
  fixed <- scale(fixed, scale = FALSE)
  list(
    value = rows[[claim$measure]], label = ifelse(rows$condition %in% subject, 0.5, -0.5),
    person = factor(rows$person), fixed = fixed[, colSums(abs(fixed)) > 0, drop = FALSE]
  )
}

# The condition's effect in a linear mixed model with a random intercept for each person (REML).
mixed <- function(table) {
  people <- nlevels(table$person)
  design <- cbind(1, table$label, table$fixed)
  if (people < 2 || length(table$value) == people || !spreads(table$value)) return(list())
  if (qr(design)$rank < ncol(design) || ncol(design) >= nrow(design)) return(list())
  scale <- sd(table$value)
  data <- data.frame(value = table$value / scale, person = table$person)
  data$design <- design
  control <- lmeControl(opt = "optim", msTol = 1e-15, niterEM = 500, returnObject = TRUE) # six digits hold
  fitted <- suppressWarnings(
    lme(value ~ design - 1, data, random = ~ 1 | person, method = "REML", control = control)
  )
  list(estimate = scale * unname(fixef(fitted)[2]), se = scale * sqrt(vcov(fitted)[2, 2]))
}

# The p of the condition's t when the two sides of any person are swapped.
swapped_p <- function(table) {
  people <- nlevels(table$person)
  if (people < 2 || people > 13 || !spreads(table$value)) return(NA)
  own <- sapply(levels(table$person), function(one) as.numeric(table$person == one))
  held <- svd(cbind(own, table$fixed))
  basis <- held$u[, held$d > 1e-9 * max(held$d), drop = FALSE]
  left <- table$value - basis %*% crossprod(basis, table$value)
  labels <- own * table$label
  labels <- labels - basis %*% crossprod(basis, labels)
  dof <- length(table$value) - ncol(basis) - 1
  if (dof < 1 || sum(rowSums(labels)^2) < 1e-9) return(NA)
  swaps <- as.matrix(expand.grid(rep(list(c(1, -1)), people)))[seq_len(2^(people - 1)), , drop = FALSE]
  square <- rowSums((swaps %*% crossprod(labels)) * swaps)
  explained <- ifelse(square > 1e-9, (swaps %*% crossprod(labels, left))^2 / pmax(square, 1e-9), 0)
  total <- sum(left^2)
  size <- sqrt(explained / pmax(total - explained, 1e-9 * total) * dof)
  mean(size >= size[1] * (1 - 1e-9))
}

# The p of Welch's t when people are permuted between two groups.
permuted_p <- function(one, other) {
  pooled <- c(one, other)
  n <- length(one)
  if (min(n, length(other)) < 2 || !spreads(pooled) || choose(length(pooled), n) > 20000) return(NA)
  pooled <- pooled - mean(pooled)
  least <- 1e-9 * mean(pooled^2)
  size <- combn(length(pooled), n, function(inside) {
    error <- var(pooled[inside]) / n + var(pooled[-inside]) / (length(pooled) - n)
    abs(mean(pooled[inside]) - mean(pooled[-inside])) / sqrt(max(error, least))
  })
  mean(size >= size[1] * (1 - 1e-9))
}

tasks_of <- function(trials, measure) unique(trials$task[!is.na(trials[[measure]])])

claims_table <- function(trials, claims, sides) {
  columns <- c(
    "n", "n_against", "mean", "sd", "mean_against", "sd_against", "difference", "low", "high", "t", "dof",
    "p", "p_holm", "d", "g", "d_low", "d_high", "estimate", "se", "p_randomisation"
  )
  table <- claims[, c("hypothesis", "measure")]
  table[columns] <- NA_real_
  for (index in seq_len(nrow(claims))) {
    claim <- claims[index, ]
    of <- function(kind) sides$name[sides$claim == claim$claim & sides$kind == kind]
    tasks <- of("task")
    if (!length(tasks) && claim$measure %in% names(trials)) tasks <- tasks_of(trials, claim$measure)
    found <- list(n = 0, n_against = 0)
    if (length(tasks) && claim$measure %in% names(trials)) {
      both <- two_sides(trials, claim, of("subject"), of("against"), tasks)
      long <- compared(trials, claim, of("subject"), of("against"), tasks)
      found <- c(
        list(
          n = length(both[[1]]), n_against = length(both[[2]]), mean = mean_of(both[[1]]),
          sd = sd_of(both[[1]]), mean_against = mean_of(both[[2]]), sd_against = sd_of(both[[2]])
        ),
        tested(claim, both[[1]], both[[2]]), mixed(long),
        list(p_randomisation = if (claim$design == "within") swapped_p(long) else permuted_p(both[[1]], both[[2]]))
      )
    }
    table[index, names(found)] <- found
  }
  known <- !is.na(table$p)
  table$p_holm[known] <- p.adjust(table$p[known], "holm")
  table
}

# Analysis of variance of a 2 x 2 design, for each measure that a claim is about.
anova_table <- function(trials, claims, sides, factors) {
  rows <- list()
  names <- unique(factors$factor)
  weights <- lapply(names, function(name) {
    theirs <- factors[factors$factor == name, ]
    setNames(theirs$level - 1.5, theirs$condition)
  })
  for (measure in if (length(names)) unique(claims$measure) else c()) {
    claim <- tail(claims[claims$measure == measure, ], 1)
    tasks <- sides$name[sides$claim == claim$claim & sides$kind == "task"]
    if (!length(tasks) && measure %in% names(trials)) tasks <- tasks_of(trials, measure)
    if (!length(tasks)) next
    means <- cell_means(trials, measure, tasks)
    conditions <- names(weights[[1]])
    if (!all(conditions %in% colnames(means))) next
    means <- means[, conditions, drop = FALSE]
    first <- weights[[1]][conditions]
    second <- weights[[2]][conditions]
    contrasts <- list(first, second, first * second)
    effects <- c(names, paste(names, collapse = " x "))
    if (claim$design == "within") {
      means <- means[stats::complete.cases(means), , drop = FALSE]
      if (nrow(means) < 2 || !spreads(as.vector(means))) next
      dof <- nrow(means) - 1
      f <- sapply(contrasts, function(weight) unname(t.test(means %*% weight)$statistic)^2)
    } else {
      long <- data.frame(value = as.vector(means), condition = rep(conditions, each = nrow(means)))
      long <- long[!is.na(long$value), ]
      dof <- nrow(long) - 4
      if (dof < 1 || length(unique(long$condition)) < 4 || !spreads(long$value)) next
      design <- sapply(contrasts, function(weight) weight[long$condition])
      f <- unname(summary(lm(long$value ~ design))$coefficients[-1, "t value"]^2)
    }
    rows[[length(rows) + 1]] <- data.frame(measure = measure, effect = effects, f = f, dof = 1, dof_error = dof)
  }
  if (!length(rows)) return(data.frame())
  table <- do.call(rbind, rows)
  table$p <- pf(table$f, table$dof, table$dof_error, lower.tail = FALSE)
  table$eta <- table$f / (table$f + table$dof_error)
  table
}

every <- read("trials")
claims <- read("claims")
sides <- read("sides")
answers <- read("answers")
measures <- setdiff(names(every), c("person", "condition", "task", "order", "trial", "excluded"))
trials <- every[is.na(every$excluded), ]
tables <- list(results = results_table(trials, measures))
if (nrow(answers)) {
  rated <- scores_of(answers)
  tables$scales <- rated$table
  for (scale in unique(answers$scale)) trials[[scale]] <- rep(NA_real_, nrow(trials))
  scores <- rated$scores[rated$scores$person %in% trials$person, ]
  at <- match(paste(scores$person, scores$condition), paste(every$person, every$condition))
  more <- trials[rep(NA_integer_, nrow(scores)), ]
  more[c("person", "condition")] <- scores[c("person", "condition")]
  more$task <- rep("questionnaire", nrow(scores))
  more$order <- every$order[at]
  more$trial <- rep(0, nrow(scores))
  for (scale in unique(answers$scale)) {
    here <- scores$scale == scale
    more[[scale]][here] <- scores$score[here]
  }
  trials <- rbind(trials, more)
}
options <- read("options")
if (nrow(options)) tables$options <- options_of(options)
tables$claims <- claims_table(trials, claims, sides)
tables$anova <- anova_table(trials, claims, sides, read("factors"))
dir.create(out, showWarnings = FALSE, recursive = TRUE)
for (name in names(tables)) {
  table <- tables[[name]]
  if (!length(table)) next
  numeric <- sapply(table, is.double)
  table[numeric] <- lapply(
    table[numeric], function(column) ifelse(is.na(column), NA, sprintf("%.17g", column))
  )
  write.csv(table, file.path(out, paste0(name, ".csv")), row.names = FALSE, na = "")
}
